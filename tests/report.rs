//! The report, quick, opened in a browser: is everything there, is it drawn, does nothing overlap.
//!
//! Without Chromium the page is only read. It is built by the program itself, so that the test needs an optimised build.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

const SECTIONS: [&str; 5] = [
    "1. Error against run time",
    "2. Pictures",
    "3. The lecture, measured",
    "4. Stiff and extreme cases",
    "5. What a scene does not need",
];

/// Two for each of five integrands and three boxes; discrepancies and three slopes.
const CHARTS: usize = 2 * 8 + 4;

/// The reference and its error; three for each of eight methods; five of adaptive sampling.
const IMAGES: usize = 2 + 3 * 8 + 5;

fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs the program and returns the folder of the page.
fn quick() -> PathBuf {
    let folder = scratch("report");
    let run = Command::new(env!("CARGO"))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args([
            "run",
            "--release",
            "--quiet",
            "--all-features",
            "--example",
            "report",
            "--",
        ])
        .args(["--quick", "--alone", "--out"])
        .arg(&folder)
        .output()
        .unwrap();
    assert!(
        run.status.success(),
        "{}",
        String::from_utf8_lossy(&run.stderr)
    );
    folder
}

#[test]
#[cfg_attr(debug_assertions, ignore = "takes minutes without optimisation")]
fn the_quick_page_is_complete_in_a_browser() {
    let folder = quick();
    let html = std::fs::read_to_string(folder.join("index.html")).unwrap();
    read(&folder, &html);
    let Some(browser) = browser() else {
        println!("Chromium is not installed: the page was not opened");
        return;
    };
    // The same page with a script that looks at it.
    let look = format!("<script>{}</script></body>", include_str!("report/look.js"));
    let looked_at = folder.join("looked_at.html");
    std::fs::write(&looked_at, html.replace("</body>", &look)).unwrap();
    for (width, scheme, background) in [
        (1400, "1", "rgb(255, 255, 255)"),
        (1400, "0", "rgb(22, 25, 29)"),
        (500, "1", "rgb(255, 255, 255)"),
        (500, "0", "rgb(22, 25, 29)"),
    ] {
        let seen = open(browser, &looked_at, width, scheme);
        assert_eq!(seen["faults"], Value::Array(Vec::new()), "width {width}");
        assert_eq!(seen["sections"], Value::from(SECTIONS.to_vec()));
        assert_eq!(seen["charts"], CHARTS);
        assert_eq!(seen["images"], IMAGES);
        assert_eq!(seen["background"], background);
    }
}

/// What can be told without a browser.
fn read(folder: &Path, html: &str) {
    for section in SECTIONS {
        assert!(html.contains(&format!("{section}</h2>")), "{section}");
    }
    assert_eq!(html.matches("<svg ").count(), CHARTS);
    assert_eq!(html.matches("<img ").count(), IMAGES);
    assert!(html.contains("prefers-color-scheme: dark") && html.contains("@media print"));
    assert!(!html.contains("<script"), "the page needs no script");
    for part in html.split(" src=\"").skip(1) {
        assert!(
            part.starts_with("data:image/png;base64,iVBOR"),
            "{}",
            &part[..40]
        );
    }
    let mut links = 0;
    for part in html.split("<a href=\"").skip(1) {
        let name = part.split('"').next().unwrap();
        if !name.starts_with('#') {
            let file =
                std::fs::metadata(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(file.len() > 100, "{name} is all but empty");
            links += 1;
        }
    }
    assert!(links > 15, "{links}");
    let text = html
        .split("src=\"data:")
        .map(|part| part.split_once('"').map_or(part, |p| p.1));
    for part in text {
        assert!(!part.contains("NaN"), "a number that is none");
    }
}

fn browser() -> Option<&'static str> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    names.into_iter().find(|name| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|output| output.status.success())
    })
}

/// Opens the page, and returns what it saw of itself.
fn open(browser: &str, page: &Path, width: u32, scheme: &str) -> Value {
    let profile = scratch("report-browser");
    std::fs::remove_dir_all(&profile).unwrap();
    let output = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--enable-logging=stderr",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("--window-size={width},1000"))
        .arg(format!("--blink-settings=preferredColorScheme={scheme}"))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    let console: Vec<&str> = said
        .lines()
        .filter(|line| line.contains("CONSOLE"))
        .collect();
    assert!(console.is_empty(), "{console:?}");
    let dom = String::from_utf8(output.stdout).unwrap();
    let seen = dom.split("<pre id=\"seen\">").nth(1);
    let seen = seen.unwrap_or_else(|| panic!("the browser did not get through the page: {said}"));
    let seen = seen.split("</pre>").next().unwrap();
    let seen = seen
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&amp;", "&");
    serde_json::from_str(&seen).unwrap()
}

#[test]
fn a_study_of_ones_own_is_short() {
    let lines = include_str!("../examples/own_study.rs").lines().count();
    assert!(lines <= 40, "{lines}");
}
