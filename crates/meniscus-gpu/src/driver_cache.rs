//! What a driver has compiled, as bytes that may be given back to it: sealed when they leave the
//! driver, and opened only where the seal is whole.
//!
//! A sealed text is [`MAGIC`], the BLAKE3 hash of all that follows, the length of the key (four bytes,
//! the lowest first), the key, and the driver's data.

/// What sealed data begins with; the last letter is the version of the layout.
const MAGIC: &[u8; 8] = b"meniscA1";
const HASH_LEN: usize = blake3::OUT_LEN;
const KEY_AT: usize = MAGIC.len() + HASH_LEN;
const DATA_AT: usize = KEY_AT + size_of::<u32>();

/// The version of wgpu whose data this is; a test holds it against the lock file.
const WGPU: &str = "30";

/// What compiled pipelines hang on, in words: the adapter, its driver, and the programs that handed
/// the shaders over. None where the graphics interface has no such data.
pub(crate) fn key(info: &wgpu::AdapterInfo) -> Option<String> {
    let device = wgpu::util::pipeline_cache_key(info)?;
    let wgpu::AdapterInfo {
        name,
        driver,
        driver_info,
        ..
    } = info;
    let own = env!("CARGO_PKG_VERSION");
    Some(format!(
        "{device}\n{name}\n{driver}\n{driver_info}\nwgpu {WGPU}\nmeniscus {own}"
    ))
}

/// Data that a driver gave away under a key, by its seal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Unsealed<'d>(&'d [u8]);

impl<'d> Unsealed<'d> {
    /// The data in a sealed text; none where anything of it is not as it was sealed, or where it was
    /// sealed under another key.
    pub fn open(sealed: &'d [u8], key: &str) -> Option<Self> {
        let body = sealed.strip_prefix(MAGIC)?;
        let (hash, body) = body.split_first_chunk::<HASH_LEN>()?;
        if blake3::hash(body) != blake3::Hash::from_bytes(*hash) {
            return None;
        }
        let (length, body) = body.split_first_chunk()?;
        let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
        let (of, data) = body.split_at_checked(length)?;
        (of == key.as_bytes()).then_some(Self(data))
    }

    /// The driver's data.
    pub fn data(self) -> &'d [u8] {
        self.0
    }
}

/// A driver's data, sealed under a key; none where the key is too long for its length to be told.
pub(crate) fn seal(data: &[u8], key: &str) -> Option<Vec<u8>> {
    let length = u32::try_from(key.len()).ok()?;
    let mut sealed = Vec::with_capacity(DATA_AT + key.len() + data.len());
    sealed.extend(MAGIC);
    sealed.extend([0; HASH_LEN]);
    sealed.extend(length.to_le_bytes());
    sealed.extend(key.as_bytes());
    sealed.extend(data);
    let hash = blake3::hash(&sealed[KEY_AT..]);
    sealed[MAGIC.len()..KEY_AT].copy_from_slice(hash.as_bytes());
    Some(sealed)
}

/// A driver's cache of compiled pipelines, with what it holds already. The device is to have been
/// opened with [`wgpu::Features::PIPELINE_CACHE`].
#[allow(
    unsafe_code,
    reason = "drivers trust the bytes that they are given, so that wgpu cannot offer this as safe"
)]
pub(crate) fn driver_cache(
    device: &wgpu::Device,
    held: Option<Unsealed<'_>>,
) -> wgpu::PipelineCache {
    let descriptor = wgpu::PipelineCacheDescriptor {
        label: Some("compiled pipelines"),
        data: held.map(Unsealed::data),
        // Data that the driver does not want is left aside.
        fallback: true,
    };
    // SAFETY: `data` has to come from `wgpu::PipelineCache::get_data`. `Unsealed` is made by
    // `Unsealed::open` alone, from a text whose hash over key and data is whole: one that `seal`
    // wrote, of which nothing was lost or changed. `seal` is called with what `get_data` returned,
    // and with the key of adapter, driver, wgpu and this program, which `open` has compared with the
    // present one. A hash does not keep out who means harm; for that the texts lie in a folder that
    // only their owner may write to (`kept_pipelines.rs`), who needs no file to run programs.
    unsafe { device.create_pipeline_cache(&descriptor) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_sealed_is_opened_with_its_key_alone() {
        for data in [&b""[..], b"x", &[7; 5000]] {
            let sealed = seal(data, "a key").unwrap();
            let opened = Unsealed::open(&sealed, "a key").unwrap();
            assert_eq!(opened.data(), data);
            for other in ["", "a ke", "a key ", "another"] {
                assert_eq!(Unsealed::open(&sealed, other), None, "{other}");
            }
        }
    }

    #[test]
    fn a_change_anywhere_and_every_shorter_or_longer_text_is_refused() {
        let sealed = seal(b"compiled", "key").unwrap();
        for at in 0..sealed.len() {
            for bit in 0..8 {
                let mut wrong = sealed.clone();
                wrong[at] ^= 1 << bit;
                assert_eq!(Unsealed::open(&wrong, "key"), None, "byte {at}, bit {bit}");
            }
            assert_eq!(Unsealed::open(&sealed[..at], "key"), None, "{at} bytes");
        }
        let longer = [&sealed[..], b"x"].concat();
        assert_eq!(Unsealed::open(&longer, "key"), None);
    }

    #[test]
    fn a_length_beyond_the_end_is_refused_even_under_a_true_hash() {
        let mut sealed = seal(b"data", "key").unwrap();
        for length in [8_u32, 1000, u32::MAX] {
            sealed[KEY_AT..DATA_AT].copy_from_slice(&length.to_le_bytes());
            let hash = blake3::hash(&sealed[KEY_AT..]);
            sealed[MAGIC.len()..KEY_AT].copy_from_slice(hash.as_bytes());
            assert_eq!(Unsealed::open(&sealed, "key"), None, "{length}");
        }
    }

    #[test]
    fn the_key_names_the_library_that_is_used() {
        let lock = include_str!("../../../Cargo.lock");
        let mut line = lock.lines().skip_while(|line| *line != r#"name = "wgpu""#);
        let version = line.nth(1).expect("wgpu's version");
        assert!(
            version.starts_with(&format!("version = \"{WGPU}.")),
            "{version}: name it in WGPU"
        );
    }
}
