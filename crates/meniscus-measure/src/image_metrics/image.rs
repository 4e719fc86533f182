//! A picture of linear colours.

use std::path::Path;

use image::{DynamicImage, ImageReader};

use crate::{MeasureError, srgb_to_linear};

/// A picture of linear colours with sRGB's primaries, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    size: [u32; 2],
    pixels: Vec<[f32; 3]>,
}

impl Image {
    /// A picture of `size` (width, height) with one colour per pixel.
    ///
    /// # Errors
    /// [`MeasureError::Length`] when the colours do not fill the picture, [`MeasureError::Value`]
    /// when it has no pixels.
    pub fn new(size: [u32; 2], pixels: Vec<[f32; 3]>) -> Result<Self, MeasureError> {
        if size.contains(&0) {
            return Err(MeasureError::value(
                "size of a picture",
                format!("{}×{} has no pixels", size[0], size[1]),
            ));
        }
        let expected = size[0] as usize * size[1] as usize;
        MeasureError::check_length("colours of a picture", pixels.len(), expected)?;
        Ok(Self { size, pixels })
    }

    /// A picture from 8-bit sRGB, three bytes a pixel.
    ///
    /// # Errors
    /// As [`Image::new`].
    pub fn from_srgb8(size: [u32; 2], rgb: &[u8]) -> Result<Self, MeasureError> {
        let table: Vec<f32> = (0..=255u8)
            .map(|code| srgb_to_linear(f64::from(code) / 255.0) as f32)
            .collect();
        let (pixels, rest) = rgb.as_chunks::<3>();
        MeasureError::check_length("bytes left over in a picture", rest.len(), 0)?;
        Self::new(
            size,
            pixels
                .iter()
                .map(|p| p.map(|code| table[usize::from(code)]))
                .collect(),
        )
    }

    /// Reads a picture: PNG as sRGB (8 or 16 bits a channel), EXR as linear colours.
    ///
    /// Opacity is left out of account. NaN and infinite values of an EXR file are kept, for the
    /// measures to count.
    ///
    /// # Errors
    /// [`MeasureError::File`] when the file cannot be read, [`MeasureError::Format`] when it does not
    /// hold a picture that can be decoded.
    pub fn read(path: &Path) -> Result<Self, MeasureError> {
        let file = |source| MeasureError::File {
            path: path.to_owned(),
            source,
        };
        let decoded = ImageReader::open(path)
            .and_then(ImageReader::with_guessed_format)
            .map_err(file)?
            .decode()
            .map_err(|e| MeasureError::format(path.display().to_string(), e))?;
        let size = [decoded.width(), decoded.height()];
        match decoded {
            DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
                Self::new(size, decoded.into_rgb32f().pixels().map(|p| p.0).collect())
            }
            DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_) => {
                let linear = |code: u16| srgb_to_linear(f64::from(code) / 65535.0) as f32;
                let pixels = decoded
                    .into_rgb16()
                    .pixels()
                    .map(|p| p.0.map(linear))
                    .collect();
                Self::new(size, pixels)
            }
            _ => Self::from_srgb8(size, decoded.into_rgb8().as_raw()),
        }
    }

    /// Width and height in pixels; neither is 0.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The linear colours, row by row from the top left.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Rgb, Rgba};

    #[test]
    fn a_png_of_either_depth_is_decoded_to_the_same_light() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        let (eight, sixteen) = (at("8.png"), at("16.png"));
        ImageBuffer::from_pixel(2, 1, Rgb([0u8, 128, 255]))
            .save(&eight)
            .unwrap();
        ImageBuffer::from_pixel(2, 1, Rgba([0u16, 128 * 257, 65535, 9]))
            .save(&sixteen)
            .unwrap();
        let (a, b) = (Image::read(&eight).unwrap(), Image::read(&sixteen).unwrap());
        assert_eq!(a, b);
        // Half of the codes is about a fifth of the light.
        assert!((a.pixels()[0][1] - 0.2158).abs() < 1e-3);
        assert_eq!((a.pixels()[0][0], a.pixels()[0][2]), (0.0, 1.0));
    }

    #[test]
    fn an_exr_keeps_its_values_the_broken_ones_too() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("hdr.exr");
        let mut written = ImageBuffer::from_pixel(3, 2, Rgb([0.25f32, 700.0, -1.0]));
        written.put_pixel(1, 1, Rgb([f32::NAN, f32::INFINITY, 0.0]));
        written.save(&path).unwrap();
        let read = Image::read(&path).unwrap();
        assert_eq!(
            (read.size(), read.pixels()[0]),
            ([3, 2], [0.25, 700.0, -1.0])
        );
        assert!(read.pixels()[4][0].is_nan() && read.pixels()[4][1].is_infinite());
    }

    #[test]
    fn what_is_no_picture_is_named() {
        let directory = tempfile::tempdir().unwrap();
        for (name, content) in [
            ("text.png", &b"not a picture"[..]),
            ("cut.png", &b"\x89PNG\r\n\x1a\n\0\0"[..]),
            ("cut.exr", &b"\x76\x2f\x31\x01\x02"[..]),
        ] {
            let path = directory.path().join(name);
            std::fs::write(&path, content).unwrap();
            let said = Image::read(&path).unwrap_err().to_string();
            assert!(said.contains(name), "{said}");
        }
        let said = Image::read(Path::new("absent.png"))
            .unwrap_err()
            .to_string();
        assert!(said.contains("absent.png"), "{said}");
    }

    #[test]
    fn impossible_sizes_are_refused() {
        assert!(Image::new([0, 3], vec![]).is_err());
        assert!(Image::new([2, 2], vec![[0.0; 3]; 3]).is_err());
        assert!(Image::from_srgb8([1, 1], &[1, 2, 3, 4]).is_err());
    }
}
