//! Files that are there whole or not at all.

use std::io::{Cursor, Write};
use std::path::Path;

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use crate::MeasureError;

/// Writes a file by way of a temporary one beside it, which then takes its name.
///
/// Whoever reads `path` sees the old content or the new, never a part. A missing directory is created.
///
/// # Errors
/// [`MeasureError::File`] when the system refuses; the temporary file is removed then.
pub fn write_atomically(path: &Path, bytes: &[u8]) -> Result<(), MeasureError> {
    write(path, bytes).map_err(|source| MeasureError::File {
        path: path.to_owned(),
        source,
    })
}

fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(directory)?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".writing-");
    // Temporary files are private unless told otherwise; the umask still applies to this.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut temporary = builder.tempfile_in(directory)?;
    temporary.write_all(bytes)?;
    temporary.persist(path).map_err(|refused| refused.error)?;
    Ok(())
}

/// An 8-bit RGB picture as the bytes of a PNG file; `rgb` has three bytes a pixel, row by row.
///
/// # Errors
/// [`MeasureError::Length`] when `rgb` does not fill the picture, [`MeasureError::Format`] when the
/// picture cannot be encoded (a side of no pixels).
pub fn png_bytes(size: [u32; 2], rgb: &[u8]) -> Result<Vec<u8>, MeasureError> {
    let expected = size[0] as usize * size[1] as usize * 3;
    MeasureError::check_length("bytes of a picture", rgb.len(), expected)?;
    let mut bytes = Cursor::new(Vec::new());
    PngEncoder::new(&mut bytes)
        .write_image(rgb, size[0], size[1], ExtendedColorType::Rgb8)
        .map_err(|e| MeasureError::format("picture", e))?;
    Ok(bytes.into_inner())
}

/// Writes an 8-bit RGB picture as PNG, whole or not at all. See [`png_bytes`], [`write_atomically`].
///
/// # Errors
/// Those of both.
pub fn write_png(path: &Path, size: [u32; 2], rgb: &[u8]) -> Result<(), MeasureError> {
    write_atomically(path, &png_bytes(size, rgb)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_nothing_else_is_left() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("new/deep/file.txt");
        write_atomically(&path, b"first").unwrap();
        write_atomically(&path, b"second").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
        assert_eq!(path.parent().unwrap().read_dir().unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_what_is_written_as_far_as_the_umask_lets_them() {
        use std::os::unix::fs::PermissionsExt;
        let directory = tempfile::tempdir().unwrap();
        let mode = |name: &str| {
            let path = directory.path().join(name);
            std::fs::metadata(path).unwrap().permissions().mode()
        };
        std::fs::write(directory.path().join("plain"), b"").unwrap();
        write_atomically(&directory.path().join("atomic"), b"").unwrap();
        assert_eq!(mode("atomic"), mode("plain"));
    }

    #[test]
    fn a_refusal_names_the_file_and_leaves_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("taken");
        std::fs::create_dir(&path).unwrap();
        let said = write_atomically(&path, b"x").unwrap_err().to_string();
        assert!(said.contains("taken"), "{said}");
        assert_eq!(directory.path().read_dir().unwrap().count(), 1);
    }

    #[test]
    fn a_picture_is_read_back_as_written() {
        let rgb: Vec<u8> = (0..24).map(|i| i * 10).collect();
        let bytes = png_bytes([4, 2], &rgb).unwrap();
        let back = image::load_from_memory(&bytes).unwrap().into_rgb8();
        assert_eq!((back.dimensions(), back.into_raw()), ((4, 2), rgb));
    }

    #[test]
    fn impossible_pictures_are_refused() {
        assert!(png_bytes([2, 2], &[0; 11]).is_err());
        assert!(png_bytes([0, 0], &[]).is_err());
    }
}
