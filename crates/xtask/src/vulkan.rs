//! Whether a Vulkan adapter can be expected, told from the files of the machine.
//!
//! The loader's rules are those of the Vulkan loader's documentation, "Driver Discovery on Linux".

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The loader's library.
const LOADER: &str = "libvulkan.so.1";

/// Parts of the names of manifests whose drivers need no device.
const SOFTWARE: [&str; 3] = ["lvp", "lavapipe", "swiftshader"];

/// What a search looks at.
pub(crate) struct Machine<'a> {
    /// Where the file system begins.
    pub(crate) root: PathBuf,
    /// Environment variables.
    pub(crate) variable: &'a dyn Fn(&str) -> Option<OsString>,
    /// What `ldconfig -p` prints; empty where there is none.
    pub(crate) libraries: String,
}

/// What a search found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Found {
    /// A driver that can be expected to work: its manifest.
    Adapter(PathBuf),
    /// What is missing, in words.
    Missing(&'static str),
    /// The environment names drivers, which hides all others, and none of them is there.
    Hidden,
}

impl Machine<'_> {
    /// Looks for a loader, and for a driver with something to drive.
    pub(crate) fn search(&self) -> Found {
        if !self.has_loader() {
            return Found::Missing("the Vulkan loader (libvulkan.so.1)");
        }
        let drivers = self.drivers();
        if drivers.is_empty() {
            return match self.named_drivers() {
                Some(_) => Found::Hidden,
                None => Found::Missing("a Vulkan driver"),
            };
        }
        // Distributions install the drivers of all makers together, whatever is plugged in.
        let driver = if self.has_device() {
            drivers.first()
        } else {
            drivers.iter().find(|driver| is_software(driver))
        };
        match driver {
            Some(driver) => Found::Adapter(driver.clone()),
            None => Found::Missing("a Vulkan driver that works without a graphics device"),
        }
    }

    fn has_loader(&self) -> bool {
        if self.libraries.contains(LOADER) {
            return true;
        }
        let mut directories: Vec<PathBuf> =
            ["usr/lib", "usr/lib64", "usr/local/lib", "lib", "lib64"]
                .iter()
                .map(|directory| self.root.join(directory))
                .collect();
        // Debian keeps libraries in a directory an architecture.
        for multiarch in entries(&self.root.join("usr/lib")) {
            let name = multiarch.file_name().unwrap_or_default().to_string_lossy();
            if name.contains("-linux-") {
                directories.push(multiarch);
            }
        }
        directories.extend(self.paths("LD_LIBRARY_PATH"));
        directories
            .iter()
            .any(|directory| directory.join(LOADER).exists())
    }

    /// Manifests of drivers, in the order of the loader.
    fn drivers(&self) -> Vec<PathBuf> {
        if let Some(named) = self.named_drivers() {
            return named.iter().flat_map(|path| manifests(path)).collect();
        }
        let mut places = self.paths("VK_ADD_DRIVER_FILES");
        let home = (self.variable)("HOME").map(PathBuf::from);
        let user = |variable: &str, default: &str| match self.paths(variable) {
            paths if paths.is_empty() => home.iter().map(|home| home.join(default)).collect(),
            paths => paths,
        };
        let system = |variable: &str, defaults: &[&str]| match self.paths(variable) {
            paths if paths.is_empty() => defaults.iter().map(|d| self.root.join(d)).collect(),
            paths => paths,
        };
        let bases: [Vec<PathBuf>; 5] = [
            user("XDG_CONFIG_HOME", ".config"),
            system("XDG_CONFIG_DIRS", &["etc/xdg"]),
            vec![self.root.join("etc")],
            user("XDG_DATA_HOME", ".local/share"),
            system("XDG_DATA_DIRS", &["usr/local/share", "usr/share"]),
        ];
        places.extend(bases.iter().flatten().map(|base| base.join("vulkan/icd.d")));
        places.iter().flat_map(|place| manifests(place)).collect()
    }

    /// Drivers that the environment names, the newer variable going first.
    fn named_drivers(&self) -> Option<Vec<PathBuf>> {
        ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"]
            .iter()
            .map(|variable| self.paths(variable))
            .find(|named| !named.is_empty())
    }

    fn has_device(&self) -> bool {
        let is_render_node = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("renderD")
        };
        entries(&self.root.join("dev/dri"))
            .iter()
            .any(is_render_node)
            || ["dev/nvidia0", "dev/dxg", "dev/mali0", "dev/kgsl-3d0"]
                .iter()
                .any(|device| self.root.join(device).exists())
    }

    /// A variable that holds paths; relative and empty ones are left out, as the loader does.
    fn paths(&self, variable: &str) -> Vec<PathBuf> {
        let value = (self.variable)(variable).unwrap_or_default();
        std::env::split_paths(&value)
            .filter(|path| path.is_absolute())
            .collect()
    }
}

fn is_software(manifest: &Path) -> bool {
    let name = manifest.file_name().unwrap_or_default().to_string_lossy();
    let name = name.to_lowercase();
    SOFTWARE.iter().any(|software| name.contains(software))
}

/// A manifest itself, or those in a directory.
fn manifests(place: &Path) -> Vec<PathBuf> {
    if place.is_file() {
        return vec![place.to_owned()];
    }
    let mut found = entries(place);
    found.retain(|path| path.extension().is_some_and(|end| end == "json"));
    found
}

/// What a directory holds, in order of names; nothing where there is none.
fn entries(directory: &Path) -> Vec<PathBuf> {
    let Ok(read) = std::fs::read_dir(directory) else {
        return Vec::new();
    };
    let mut entries: Vec<PathBuf> = read.flatten().map(|entry| entry.path()).collect();
    entries.sort();
    entries
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    const LIBRARY: &str = "usr/lib/x86_64-linux-gnu/libvulkan.so.1";
    const LAVAPIPE: &str = "usr/share/vulkan/icd.d/lvp_icd.x86_64.json";
    const RADEON: &str = "usr/share/vulkan/icd.d/radeon_icd.x86_64.json";

    /// What is found on a machine with these files, given as paths under its root.
    fn found(files: &[&str], variables: &[(&str, &str)]) -> Found {
        let root = tempfile::tempdir().expect("a temporary directory");
        let inside = |path: &str| root.path().join(path);
        for file in files {
            let path = inside(file);
            std::fs::create_dir_all(path.parent().expect("a parent")).expect("a directory");
            std::fs::write(path, "{}").expect("a file");
        }
        let machine = Machine {
            root: root.path().to_owned(),
            variable: &|name| {
                let value = variables.iter().find(|(variable, _)| *variable == name);
                value.map(|(_, path)| inside(path).into_os_string())
            },
            libraries: String::new(),
        };
        match machine.search() {
            Found::Adapter(path) => {
                let path = path.strip_prefix(root.path()).expect("inside of the root");
                Found::Adapter(path.to_owned())
            }
            other => other,
        }
    }

    fn is_missing(found: &Found, what: &str) -> bool {
        matches!(found, Found::Missing(words) if words.contains(what))
    }

    #[test]
    fn both_the_loader_and_a_driver_are_needed() {
        assert!(is_missing(&found(&[], &[]), "loader"));
        assert!(is_missing(&found(&[LAVAPIPE], &[]), "loader"));
        assert!(is_missing(&found(&[LIBRARY], &[]), "driver"));
        let both = found(&[LIBRARY, LAVAPIPE], &[]);
        assert_eq!(both, Found::Adapter(LAVAPIPE.into()));
    }

    #[test]
    fn a_driver_of_hardware_needs_a_device() {
        let without = found(&[LIBRARY, RADEON], &[]);
        assert!(is_missing(&without, "without a graphics device"));
        let with = found(&[LIBRARY, RADEON, "dev/dri/renderD128"], &[]);
        assert_eq!(with, Found::Adapter(RADEON.into()));
        // A display without a GPU behind it, as in virtual machines.
        let display = found(&[LIBRARY, RADEON, "dev/dri/card0"], &[]);
        assert!(is_missing(&display, "without a graphics device"));
        let software = found(&[LIBRARY, RADEON, LAVAPIPE], &[]);
        assert_eq!(software, Found::Adapter(LAVAPIPE.into()));
    }

    #[test]
    fn drivers_that_are_named_hide_all_others() {
        let named = [("VK_DRIVER_FILES", "opt/lvp.json")];
        assert_eq!(found(&[LIBRARY, LAVAPIPE], &named), Found::Hidden);
        let there = found(&[LIBRARY, LAVAPIPE, "opt/lvp.json"], &named);
        assert_eq!(there, Found::Adapter("opt/lvp.json".into()));
        let added = [("VK_ADD_DRIVER_FILES", "opt")];
        let there = found(&[LIBRARY, "opt/lvp.json"], &added);
        assert_eq!(there, Found::Adapter("opt/lvp.json".into()));
    }

    #[test]
    fn the_loader_may_be_where_the_user_says() {
        let variables = [("LD_LIBRARY_PATH", "opt/lib")];
        let files = ["opt/lib/libvulkan.so.1", LAVAPIPE];
        assert_eq!(found(&files, &variables), Found::Adapter(LAVAPIPE.into()));
        assert!(is_missing(&found(&files, &[]), "loader"));
    }

    #[test]
    fn what_is_no_manifest_is_no_driver() {
        let notes = "usr/share/vulkan/icd.d/README.lvp";
        assert!(is_missing(&found(&[LIBRARY, notes], &[]), "driver"));
    }
}
