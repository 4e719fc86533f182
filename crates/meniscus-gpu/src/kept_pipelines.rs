//! Compiled pipelines in a file, from one run of a program to the next.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use crate::driver_cache::{Unsealed, driver_cache, key, seal};

/// The variable that names the folder, or turns keeping off.
const VARIABLE: &str = "MENISCUS_CACHE";
/// What turns keeping off.
const OFF: &str = "off";

/// Beyond so many bytes a file is not read, and not written: the next run starts anew. Drivers never
/// forget what they have compiled.
const MOST_BYTES: u64 = 64 << 20;

/// The folder for what may be lost, as the environment says: that of the variable `MENISCUS_CACHE`;
/// none where that is `off`; without it `meniscus` in the user's own folder for caches
/// (`XDG_CACHE_HOME` or `~/.cache`, `~/Library/Caches` on macOS, `%LOCALAPPDATA%` on Windows), if there
/// is one.
pub fn cache_folder() -> Option<PathBuf> {
    if let Some(said) = std::env::var_os(VARIABLE).filter(|said| !said.is_empty()) {
        return (said != OFF).then(|| said.into());
    }
    let absolute = |name: &str| {
        let path = std::env::var_os(name).map(PathBuf::from);
        path.filter(|path| path.is_absolute())
    };
    let own = if cfg!(windows) {
        absolute("LOCALAPPDATA")
    } else if cfg!(target_vendor = "apple") {
        absolute("HOME").map(|home| home.join("Library/Caches"))
    } else {
        absolute("XDG_CACHE_HOME").or_else(|| Some(absolute("HOME")?.join(".cache")))
    };
    own.map(|own| own.join("meniscus"))
}

/// A driver's compiled pipelines, and the file that they are kept in.
#[derive(Debug)]
pub(crate) struct KeptPipelines {
    cache: wgpu::PipelineCache,
    folder: PathBuf,
    file: PathBuf,
    key: String,
    /// Hash of what the file held.
    held: Option<blake3::Hash>,
}

impl KeptPipelines {
    /// Gives the driver what the folder holds for it; nothing where that is unusable. None where the
    /// adapter's driver hands nothing out.
    pub fn open(device: &wgpu::Device, folder: &Path) -> Option<Self> {
        if !device.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return None;
        }
        let info = device.adapter_info();
        let key = key(&info)?;
        let folder = folder.join("pipelines");
        let name = wgpu::util::pipeline_cache_key(&info)?;
        let file = folder.join(format!("{name}.bin"));
        let sealed = match is_ours(&folder) {
            true => read(&file),
            false => None,
        };
        let held = sealed
            .as_deref()
            .and_then(|sealed| Unsealed::open(sealed, &key));
        Some(Self {
            cache: driver_cache(device, held),
            folder,
            held: held.map(|held| blake3::hash(held.data())),
            file,
            key,
        })
    }

    /// The driver's cache.
    pub fn cache(&self) -> &wgpu::PipelineCache {
        &self.cache
    }

    /// Whether the file held something that was given to the driver.
    #[cfg(test)]
    pub fn was_found(&self) -> bool {
        self.held.is_some()
    }

    /// Writes what the driver has compiled by now, where that is not what the file held. Whatever
    /// hinders it, pipelines are compiled anew in the next run, and that is all.
    pub fn keep(&self) {
        let Some(data) = self.cache.get_data() else {
            return;
        };
        if self.held == Some(blake3::hash(&data)) {
            return;
        }
        let sealed = seal(&data, &self.key).filter(|sealed| sealed.len() as u64 <= MOST_BYTES);
        // Errors are those of full disks and of folders that cannot be written to.
        let _ = match sealed {
            Some(sealed) => write(&self.folder, &self.file, &sealed),
            None => fs::remove_file(&self.file),
        };
    }
}

/// Reads a file that is not too large.
fn read(file: &Path) -> Option<Vec<u8>> {
    let file = fs::File::open(file).ok()?;
    let mut bytes = Vec::new();
    // One byte more than allowed, to tell.
    file.take(MOST_BYTES + 1).read_to_end(&mut bytes).ok()?;
    (bytes.len() as u64 <= MOST_BYTES).then_some(bytes)
}

fn write(folder: &Path, file: &Path, bytes: &[u8]) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    if !is_ours(folder) {
        return Ok(());
    }
    let mut whole = tempfile::NamedTempFile::new_in(folder)?;
    whole.write_all(bytes)?;
    whole.persist(file)?;
    Ok(())
}

/// Whether nobody but the user can have put something into a folder. That only owners can change a
/// folder's rights tells whose it is.
#[cfg(unix)]
fn is_ours(folder: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt;
    // A link may lead to a folder whose rights are not to be changed.
    let is_folder = fs::symlink_metadata(folder).is_ok_and(|there| there.is_dir());
    is_folder && fs::set_permissions(folder, fs::Permissions::from_mode(0o700)).is_ok()
}

/// Elsewhere the user's folders are the user's own.
#[cfg(not(unix))]
fn is_ours(folder: &Path) -> bool {
    folder.is_dir()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Gpu, pipelines};

    const SHADER: &str = "@group(0) @binding(0) var<storage, read_write> all: array<f32, 64>;
        @compute @workgroup_size(64) fn run(@builtin(local_invocation_index) i: u32) {
            all[i] = sin(f32(i)) * cos(f32(i) + 1.0);
        }";

    /// Opens an adapter, compiles something, and lets go of it; whether something was found, and the
    /// file. None where the adapter's driver hands nothing out.
    fn run(folder: &Path) -> Option<(bool, PathBuf)> {
        let gpu = Gpu::keeping(None, Some(folder)).unwrap_or_else(|e| panic!("{e}"));
        let kept = gpu.kept()?;
        let found = (kept.was_found(), kept.file.clone());
        let module = naga::front::wgsl::parse_str(SHADER).unwrap();
        let module = pipelines::shader_module(&gpu, "test", &module).unwrap();
        gpu.compile("a pipeline", || {
            gpu.device()
                .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: None,
                    layout: None,
                    module: &module,
                    entry_point: Some("run"),
                    compilation_options: Default::default(),
                    cache: gpu.driver_cache(),
                })
        })
        .unwrap();
        Some(found)
    }

    /// A folder in which one run has left its pipelines, with their file.
    fn kept() -> Option<(tempfile::TempDir, PathBuf)> {
        let folder = tempfile::tempdir().unwrap();
        let (found, file) = run(folder.path())?;
        assert!(!found);
        assert!(file.is_file(), "{}", file.display());
        Some((folder, file))
    }

    #[test]
    fn what_one_run_compiles_the_next_one_finds() {
        let Some((folder, file)) = kept() else { return };
        let written = fs::metadata(&file).unwrap().modified().unwrap();
        assert!(run(folder.path()).unwrap().0);
        // What has not changed is not written again.
        assert_eq!(fs::metadata(&file).unwrap().modified().unwrap(), written);
        let others = fs::read_dir(file.parent().unwrap()).unwrap();
        assert_eq!(others.count(), 1, "nothing half written stays");
    }

    #[test]
    fn what_is_broken_is_ignored_and_written_anew() {
        let Some((folder, file)) = kept() else { return };
        let whole = fs::read(&file).unwrap();
        let mut wrong = vec![vec![], vec![0; 200], whole[..whole.len() / 2].to_vec()];
        wrong.push([&whole[..], &whole[..]].concat());
        for at in [0, 9, 41, 60, whole.len() - 1] {
            let mut one = whole.clone();
            one[at] ^= 0x40;
            wrong.push(one);
        }
        for (index, wrong) in wrong.iter().enumerate() {
            fs::write(&file, wrong).unwrap();
            assert!(!run(folder.path()).unwrap().0, "{index}");
            assert!(run(folder.path()).unwrap().0, "{index}: not written anew");
        }
    }

    #[test]
    fn what_another_driver_compiled_is_ignored_and_written_over() {
        let Some((folder, file)) = kept() else { return };
        let theirs = seal(b"of another driver", "another key").unwrap();
        fs::write(&file, &theirs).unwrap();
        assert!(!run(folder.path()).unwrap().0);
        assert_ne!(fs::read(&file).unwrap(), theirs);
        assert!(run(folder.path()).unwrap().0);
    }

    #[test]
    fn a_file_that_has_grown_too_large_is_started_anew() {
        let Some((folder, file)) = kept() else { return };
        let large = fs::OpenOptions::new().write(true).open(&file).unwrap();
        large.set_len(MOST_BYTES + 1).unwrap();
        assert_eq!(read(&file), None);
        assert!(!run(folder.path()).unwrap().0);
        assert!(fs::metadata(&file).unwrap().len() < MOST_BYTES);
    }

    #[test]
    fn a_folder_that_cannot_be_written_to_hinders_nothing() {
        let there = tempfile::tempdir().unwrap();
        let in_the_way = there.path().join("file");
        fs::write(&in_the_way, "not a folder").unwrap();
        if let Some((found, file)) = run(&in_the_way) {
            assert!(!found && !file.exists());
        }
    }

    #[cfg(unix)]
    #[test]
    fn the_folder_is_its_owners_alone() {
        use std::os::unix::fs::PermissionsExt;
        let Some((folder, file)) = kept() else { return };
        let inner = file.parent().unwrap();
        fs::set_permissions(inner, fs::Permissions::from_mode(0o777)).unwrap();
        run(folder.path());
        let mode = fs::metadata(inner).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o700);
    }
}
