//! The report in a browser, where Chromium is installed: keys do what the page says.

mod common;

use std::path::Path;
use std::process::Command;

use common::meniscus;

/// Presses keys once the page is ready, and leaves behind what the page said after each.
const DRIVE: &str = r##"<script>addEventListener("load", () => {
const said = [], stage = document.getElementById("stage");
const look = () => said.push(document.getElementById("state").textContent);
const press = (key, shiftKey) => {
  stage.dispatchEvent(new KeyboardEvent("keydown", { key, shiftKey, bubbles: true }));
  look();
};
look();
press("ArrowRight"); press("ArrowUp", true); press("2"); press(" "); press("3"); press("4"); press("1");
press("+"); press("[");
for (let i = 0; i < 200; i += 1) press("ArrowLeft", true);
const result = document.createElement("pre");
result.id = "driven";
result.textContent = said.slice(0, 8).concat(said.slice(-1)).join("\n") +
  `\n${document.getElementById("zoom").value} ${document.getElementById("divide").value}` +
  `\n${document.querySelectorAll("#loupes canvas").length} ${document.getElementById("viewer").hidden}`;
document.body.append(result);
});</script></body>"##;

fn browse(page: &Path, profile: &Path) -> Option<String> {
    let output = Command::new("chromium")
        .args("--headless --no-sandbox --disable-gpu --no-first-run --disable-sync".split(' '))
        .args([
            "--disable-background-networking",
            "--disable-component-update",
        ])
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(["--virtual-time-budget=10000", "--dump-dom"])
        .arg(format!("file://{}", page.display()))
        .output()
        .ok()?;
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn keys_move_the_magnifier_and_change_how_pictures_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("report.html");
    let mut arguments =
        common::words("ablate refraction/none refraction/broad --size 64x36 --rounds 2");
    arguments.extend(["--report", file.to_str().unwrap()]);
    meniscus(arguments).done();
    let page = std::fs::read_to_string(&file).unwrap();

    std::fs::write(&file, page.replace("</body>", DRIVE)).unwrap();
    let Some(dom) = browse(&file, &folder.path().join("profile")) else {
        eprintln!("no chromium: the report is not tested in a browser");
        return;
    };
    let driven = dom.split("<pre id=\"driven\">").nth(1).expect(&dom);
    let driven = driven.split("</pre>").next().unwrap();
    let expected = [
        "refraction/none | truth; pixel 32, 18",
        "refraction/none | truth; pixel 33, 18",
        "refraction/none | truth; pixel 33, 8",
        "refraction/none; pixel 33, 8",
        "truth; pixel 33, 8",
        "refraction/none less truth, times 8; pixel 33, 8",
        "errors of refraction/none; pixel 33, 8",
        // The sides are still changed.
        "truth | refraction/none; pixel 33, 8",
        "truth | refraction/none; pixel 0, 8",
        "9 45",
        "3 false",
    ];
    assert_eq!(driven.lines().collect::<Vec<_>>(), expected);
}
