//! Makes sure that there is a Vulkan adapter, with apt-get where it has to and may.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::command::{self, Failure};
use crate::vulkan::{Found, Machine};

/// A loader and a software adapter.
const PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];

/// Makes sure that there is an adapter.
pub(crate) fn set_up() -> Result<(), Failure> {
    // Metal and Direct3D 12 come with the system.
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    let missing = match search() {
        Found::Adapter(driver) => return tell(&driver),
        Found::Hidden => return Err(hidden()),
        Found::Missing(what) => what,
    };
    eprintln!("This machine lacks {missing}.");
    let system = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    let system = System::of(&system);
    let Some(prefix) = root_prefix().filter(|_| system == System::Debian) else {
        return Err(Failure::lacking(system.advice()));
    };
    install(&prefix).map_err(|failure| failure.after(&system.advice()))?;
    match search() {
        Found::Adapter(driver) => tell(&driver),
        Found::Hidden => Err(hidden()),
        Found::Missing(what) => Err(Failure::lacking(format!(
            "error: {} are installed, and still {what} is missing; `--no-setup` skips this check.",
            PACKAGES.join(" and ")
        ))),
    }
}

fn tell(driver: &Path) -> Result<(), Failure> {
    eprintln!("Vulkan driver: {}", driver.display());
    Ok(())
}

fn hidden() -> Failure {
    Failure::lacking(
        "error: VK_DRIVER_FILES or VK_ICD_FILENAMES names no Vulkan driver that is there; unset it, \
         or name one that is."
            .into(),
    )
}

fn search() -> Found {
    // Users other than root may not have its directory in PATH.
    let libraries = ["ldconfig", "/sbin/ldconfig"]
        .iter()
        .find_map(|program| command::output(program, &["-p"]));
    Machine {
        root: PathBuf::from("/"),
        variable: &|name| std::env::var_os(name),
        libraries: libraries.unwrap_or_default(),
    }
    .search()
}

/// The words before a command that make it run as root; none where that may not be.
fn root_prefix() -> Option<Vec<&'static str>> {
    let user = command::output("id", &["-u"])?;
    if user.trim() == "0" {
        return Some(Vec::new());
    }
    command::succeeds("sudo", &["-n", "true"]).then(|| vec!["sudo", "-n"])
}

fn install(prefix: &[&str]) -> Result<(), Failure> {
    eprintln!("Installing {} …", PACKAGES.join(" and "));
    let apt_get = |arguments: &[&str]| {
        let words = [
            prefix,
            &["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"],
        ]
        .concat();
        let mut command = Command::new(words[0]);
        command.args(&words[1..]).args(arguments);
        command::run(&mut command)
    };
    // One broken source makes this fail, though the packages may be in another, or known already.
    if let Err(failure) = apt_get(&["update"]) {
        eprintln!("{failure}; trying without");
    }
    let install = ["install", "--yes", "--no-install-recommends"];
    apt_get(&[install.as_slice(), PACKAGES.as_slice()].concat())
}

/// The families of systems that we know packages of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum System {
    Debian,
    Fedora,
    Arch,
    Alpine,
    Other,
}

impl System {
    /// Reads /etc/os-release; see os-release(5).
    fn of(release: &str) -> Self {
        let value = |key: &str| {
            let value = release.lines().find_map(|line| line.strip_prefix(key));
            value.unwrap_or_default().trim_matches('"').to_owned()
        };
        // Its own name first, then those it resembles.
        let names = format!("{} {}", value("ID="), value("ID_LIKE="));
        let known = names.split_whitespace().find_map(|name| match name {
            "debian" | "ubuntu" => Some(Self::Debian),
            "fedora" | "rhel" => Some(Self::Fedora),
            "arch" => Some(Self::Arch),
            "alpine" => Some(Self::Alpine),
            _ => None,
        });
        known.unwrap_or(Self::Other)
    }

    /// What to do by hand.
    fn advice(self) -> String {
        let command = match self {
            Self::Debian => &format!("sudo apt-get install {}", PACKAGES.join(" ")),
            Self::Fedora => "sudo dnf install mesa-vulkan-drivers vulkan-loader",
            Self::Arch => "sudo pacman -S vulkan-swrast vulkan-icd-loader",
            Self::Alpine => "sudo apk add mesa-vulkan-swrast vulkan-loader",
            Self::Other => {
                return "error: install a Vulkan loader and driver, Mesa's software driver for one; \
                        `--no-setup` skips this check."
                    .into();
            }
        };
        format!(
            "error: run this, then try again (`--no-setup` skips this check):\n\n    {command}\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn systems_are_known_by_their_name_or_those_they_resemble() {
        for (release, system) in [
            ("NAME=\"Debian GNU/Linux\"\nID=debian\n", System::Debian),
            ("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n", System::Debian),
            (
                "ID=\"rocky\"\nID_LIKE=\"rhel centos fedora\"\n",
                System::Fedora,
            ),
            ("ID=arch\n", System::Arch),
            ("ID=alpine\n", System::Alpine),
            ("ID=nixos\n", System::Other),
            ("VERSION_ID=debian\n", System::Other),
            ("", System::Other),
        ] {
            assert_eq!(System::of(release), system, "{release}");
        }
    }

    #[test]
    fn the_advice_for_debian_names_both_packages() {
        let advice = System::Debian.advice();
        assert!(advice.contains("apt-get install mesa-vulkan-drivers libvulkan1"));
        // One command and no more.
        assert_eq!(advice.matches("sudo").count(), 1);
    }
}
