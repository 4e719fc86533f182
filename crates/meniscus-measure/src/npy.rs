//! NumPy's .npy format, version 1.0, for buffers that others want to recompute.

use crate::MeasureError;

/// The values of an array in C order (the last index runs fastest).
#[derive(Debug, Clone, Copy)]
pub enum NpyData<'a> {
    /// 32-bit floats, `<f4`.
    F32(&'a [f32]),
    /// 64-bit floats, `<f8`.
    F64(&'a [f64]),
    /// 32-bit signed integers, `<i4`.
    I32(&'a [i32]),
    /// Truth values, `|b1`.
    Bool(&'a [bool]),
}

impl NpyData<'_> {
    fn len(&self) -> usize {
        match self {
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
            Self::I32(v) => v.len(),
            Self::Bool(v) => v.len(),
        }
    }

    fn descriptor(&self) -> &'static str {
        match self {
            Self::F32(_) => "<f4",
            Self::F64(_) => "<f8",
            Self::I32(_) => "<i4",
            Self::Bool(_) => "|b1",
        }
    }

    fn write(&self, bytes: &mut Vec<u8>) {
        match self {
            Self::F32(v) => bytes.extend(v.iter().flat_map(|x| x.to_le_bytes())),
            Self::F64(v) => bytes.extend(v.iter().flat_map(|x| x.to_le_bytes())),
            Self::I32(v) => bytes.extend(v.iter().flat_map(|x| x.to_le_bytes())),
            Self::Bool(v) => bytes.extend(v.iter().map(|x| u8::from(*x))),
        }
    }
}

/// An array as the bytes of an .npy file; write them with [`write_atomically`](crate::write_atomically).
///
/// Little-endian, C order; `shape` has the outermost dimension first (rows, columns, channels).
///
/// # Errors
/// [`MeasureError::Length`] when the shape does not hold as many values as there are.
pub fn npy_bytes(shape: &[usize], data: NpyData<'_>) -> Result<Vec<u8>, MeasureError> {
    let expected = shape
        .iter()
        .try_fold(1usize, |product, extent| product.checked_mul(*extent))
        .ok_or_else(|| {
            MeasureError::value("shape of an array", format!("{shape:?} is too large"))
        })?;
    MeasureError::check_length("values of an array", data.len(), expected)?;
    // A tuple of one needs its comma.
    let extents: String = shape.iter().map(|extent| format!("{extent}, ")).collect();
    let mut header = format!(
        "{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}",
        data.descriptor(),
        extents.trim_end()
    );
    // Magic, version and length take 10 bytes; the data starts at a multiple of 64.
    let padding = (64 - (10 + header.len() + 1) % 64) % 64;
    header.extend(std::iter::repeat_n(' ', padding));
    header.push('\n');
    let length = u16::try_from(header.len()).map_err(|_| {
        MeasureError::value(
            "shape of an array",
            format!("{} dimensions are too many", shape.len()),
        )
    })?;
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(length.to_le_bytes());
    bytes.extend(header.as_bytes());
    data.write(&mut bytes);
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads what the format's description says, not what the writer does.
    fn parse(bytes: &[u8]) -> (String, Vec<usize>, &[u8]) {
        assert_eq!(&bytes[..8], b"\x93NUMPY\x01\x00");
        let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
        assert_eq!((10 + length) % 64, 0, "data is aligned");
        let header = std::str::from_utf8(&bytes[10..10 + length]).unwrap();
        assert!(header.ends_with('\n') && header.contains("'fortran_order': False"));
        let descriptor = header.split('\'').nth(3).unwrap().to_owned();
        let inside = header.split('(').nth(1).unwrap().split(')').next().unwrap();
        let shape = inside
            .split(',')
            .map(str::trim)
            .filter(|s| !s.is_empty())
            .map(|s| s.parse().unwrap())
            .collect();
        if header.contains(&format!("({inside})")) && !inside.is_empty() {
            assert!(inside.contains(','), "a tuple of one has a comma");
        }
        (descriptor, shape, &bytes[10 + length..])
    }

    #[test]
    fn values_are_read_back_in_order() {
        let values: Vec<f32> = (0..24).map(|i| i as f32 * 0.5 - 3.0).collect();
        let bytes = npy_bytes(&[2, 3, 4], NpyData::F32(&values)).unwrap();
        let (descriptor, shape, data) = parse(&bytes);
        assert_eq!((descriptor.as_str(), shape), ("<f4", vec![2, 3, 4]));
        let back: Vec<f32> = data
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(back, values);
    }

    #[test]
    fn every_type_has_its_descriptor_and_width() {
        for (data, descriptor, width) in [
            (NpyData::F32(&[f32::NAN; 3]), "<f4", 4),
            (NpyData::F64(&[1.0; 3]), "<f8", 8),
            (NpyData::I32(&[-1; 3]), "<i4", 4),
            (NpyData::Bool(&[true, false, true]), "|b1", 1),
        ] {
            let bytes = npy_bytes(&[3], data).unwrap();
            let (found, shape, rest) = parse(&bytes);
            assert_eq!(
                (found.as_str(), shape, rest.len()),
                (descriptor, vec![3], 3 * width)
            );
        }
    }

    #[test]
    fn shapes_without_extent_and_long_ones_stay_readable() {
        assert!(
            parse(&npy_bytes(&[], NpyData::F64(&[7.0])).unwrap())
                .1
                .is_empty()
        );
        assert_eq!(
            parse(&npy_bytes(&[0, 3], NpyData::F64(&[])).unwrap()).1,
            [0, 3]
        );
        let long = vec![1; 40];
        assert_eq!(
            parse(&npy_bytes(&long, NpyData::I32(&[5])).unwrap()).1,
            long
        );
    }

    #[test]
    fn a_shape_that_does_not_fit_is_refused() {
        assert!(npy_bytes(&[2, 2], NpyData::I32(&[1, 2, 3])).is_err());
        assert!(npy_bytes(&[usize::MAX, 2], NpyData::I32(&[])).is_err());
    }
}
