//! Page of a run in an installed browser, if there is one.

mod block;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use block::{Block, Folder, run};
use impactite_output::picture::{FieldPicture, Quantity};
use impactite_report::{Check, Frames, Record, Recorder, percent, write_page};
use impactite_scene::Solver;
use impactite_scene::observe::{HistoryCsv, Observer, Pace, Pictures, RunView};

const END: f64 = 4.0e-3;

/// Pace of `looks` looks in the whole run.
fn pace(looks: f64) -> Pace {
    Pace::interval(END / looks).expect("a pace")
}

/// Names of the executable of Chromium.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

fn browser() -> Option<&'static str> {
    let answers =
        |name: &&str| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success());
    BROWSERS.into_iter().find(|name| answers(name))
}

/// Name that would end an element, a script and an attribute if it were not escaped.
const NAME: &str = "</script><script>document.body.dataset.error='injected'</script>\"'><img src=x onerror=alert(1)> `block`";

/// Write the files of a run of a block, and its page.
fn report(folder: &Path) -> PathBuf {
    let mut block = Block::new(NAME);
    let mut recorder = Recorder::new(pace(400.0));
    let mut frames = Pictures::create(folder, "frame", pace(20.0), |snapshot| {
        FieldPicture::new(800, 600).colour_by(Quantity::magnitude("velocity").unit("m/s", 1.0)).draw(snapshot)
    })
    .expect("pictures");
    let mut lowest = HistoryCsv::create(
        folder.join("height.csv"),
        [("time", "s"), ("lowest point", "m"), ("force </script>", "N")],
        pace(300.0),
        |now: &RunView<'_>| {
            let mut lowest = f64::INFINITY;
            now.bodies()[0].for_each(&mut |p| lowest = lowest.min(p.position[1]));
            Ok(vec![now.time(), lowest, 1.0e6 * (300.0 * now.time()).sin()])
        },
    )
    .expect("a history");
    let observers: Vec<&mut dyn Observer> = vec![&mut recorder, &mut frames, &mut lowest];
    let summary = run(&mut block, END, observers);
    let count = frames.frames();
    let step = END / 20.0;
    let error = recorder.worst_energy_error();
    Record::new(format!("A block on a wall {NAME}"))
        .scene("# A scene as it is written.\n[body.block]\nname = \"</pre><script>alert(1)</script>\"\nspeed = 8.0 # m/s\n")
        .setting("speed", 8.0, "m/s")
        .setting("spring", "linear <i>", "")
        .symmetry_planes(1)
        .bodies_of(&block)
        .balances(&recorder)
        .summary(&summary, 1)
        .setup(0.02)
        .picture(format!("frame_{:06}.png", count - 1), "The block after it rebounded, coloured by speed")
        .picture("nowhere.png", "A picture that is not there")
        .frames(Frames::series("", "frame", count).times((0..count).map(|n| n as f64 * step)).caption("The block on the wall."))
        .history("Height", "height.csv")
        .check(Check::within("energy error", error, "-", 0.0, 0.05, "[C] energy is conserved"))
        .check(Check::within("height <b>", 0.11, "m", 0.1, 0.02, "[S] <script>"))
        .check(Check::judged("steps", block.steps() as f64, "-", 0.0, "[C]", false).known_miss("springs are no elements"))
        .check(Check::shown("points", 160.0, "-", "counted"))
        .save(folder)
        .expect("saved");
    write_page(folder).expect("a page")
}

fn look(browser: &str, folder: &Path, file: &Path, arguments: &[&str]) -> Output {
    let profile = folder.join("profile");
    Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"])
        .args(["--enable-logging=stderr", "--virtual-time-budget=5000"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(arguments)
        .arg(format!("file://{}", file.display()))
        .output()
        .expect("the browser starts")
}

/// Value of the attribute `name` of the body element.
fn attribute(page: &str, name: &str) -> Option<String> {
    let body = &page[page.find("<body")?..];
    let body = &body[..body.find('>')?];
    let rest = &body[body.find(&format!("{name}=\""))? + name.len() + 2..];
    Some(rest[..rest.find('"')?].to_string())
}

/// Needs no browser: the page contains all data and refers to no external resources.
#[test]
fn the_page_is_whole_without_scripts_and_network() {
    let folder = Folder::new("page");
    let page = fs::read_to_string(report(&folder.0)).expect("the page");
    // No external resources: all sources are data URIs.
    for part in page.split(" src=\"").chain(page.split(" srcset=\"")).skip(1) {
        let address = part.split('"').next().unwrap_or_default();
        assert!(
            address.starts_with("data:") || part.starts_with("<!DOCTYPE"),
            "{}",
            &address[..address.len().min(80)]
        );
    }
    for forbidden in ["<link", "@import", "url(", "<img src=x", "<script>alert", "<script>document.body"] {
        assert!(!page.contains(forbidden), "the page has {forbidden:?}");
    }
    // Numbers, pictures and static charts are present without a script.
    assert!(page.matches("<svg").count() >= 7 && page.matches("data:image/png").count() == 3);
    for words in [
        "1 of 3 passed",
        "finished at 4 ms",
        "One half of the body: masses, momenta, forces and energies are of that part (times 2 for the whole), and per metre of depth.",
        "cannot read `nowhere.png`",
        "expected failure: springs are no elements",
        "What to do: ",
        "kinetic energy",
        "&lt;/pre&gt;&lt;script&gt;",
    ] {
        assert!(page.contains(words), "the page lacks {words:?}");
    }
    // The energy error has the same value in the verdict, the checks and the balances.
    let balances = Record::open(&folder.0).expect("the record").balances.expect("balances");
    assert!(page.matches(&percent(balances.energy_error.expect("motion"))).count() >= 3);
    let (missed, met) = (page.find(">failed<"), page.find(">passed<"));
    assert!(missed < met && missed.is_some(), "checks that failed come first");
}

#[test]
fn charts_are_drawn_in_a_browser() {
    let Some(browser) = browser() else {
        println!("no Chromium ({}): the page is not looked at in a browser", BROWSERS.join(", "));
        return;
    };
    let folder = Folder::new("browser");
    let page = report(&folder.0);

    // Page with an added script that reports loaded resources and sizes of charts.
    let asked = "<script>document.body.dataset.loaded=performance.getEntriesByType('resource').map(e=>e.name)\
        .filter(n=>!n.startsWith('data:')).join(' ');\
        document.body.dataset.sizes=[...document.querySelectorAll('.uplot canvas')].map(c=>c.width*c.height>0?1:0).join('');\
        document.body.dataset.painted=[...document.querySelectorAll('.uplot canvas')].map(c=>\
        c.getContext('2d').getImageData(0,0,c.width,c.height).data.some(x=>x>0)?1:0).join('');\
        const plot=document.querySelectorAll('.uplot')[2],over=plot.querySelector('.u-over'),box=over.getBoundingClientRect();\
        const mouse=(type,x)=>new MouseEvent(type,{clientX:box.left+x*box.width,clientY:box.top+0.5*box.height,bubbles:true});\
        const axis=()=>plot.querySelector('.u-value').textContent;\
        over.dispatchEvent(mouse('mouseenter',0.5));over.dispatchEvent(mouse('mousemove',0.5));\
        document.body.dataset.read=axis();\
        plot.querySelectorAll('.u-series th')[1].click();\
        document.body.dataset.off=plot.querySelectorAll('.u-series.u-off').length;\
        document.body.dataset.drawn=[...document.querySelectorAll('svg path')].map(p=>\
        getComputedStyle(p).stroke!=='none'&&p.getTotalLength()>100?1:0).join('');\
        document.body.dataset.wide=document.documentElement.scrollWidth-innerWidth;\
        document.body.dataset.pictures=[...document.images].map(i=>i.naturalWidth>0?1:0).join('')</script></body>";
    let text = fs::read_to_string(&page).expect("the page");
    let questions = folder.0.join("questions.html");
    fs::write(&questions, text.replace("</body>", asked)).expect("written");
    for window in ["--window-size=1200,900", "--window-size=420,900"] {
        let looked = look(browser, &folder.0, &questions, &["--dump-dom", window]);
        let (dom, said) = (String::from_utf8_lossy(&looked.stdout), String::from_utf8_lossy(&looked.stderr));
        assert!(looked.status.success(), "{said}");
        assert!(!said.contains("CONSOLE"), "the console says:\n{said}");
        let of = |name| attribute(&dom, name);
        assert_eq!(of("data-error"), None);
        let charts: usize = of("data-charts").and_then(|n| n.parse().ok()).expect("a number of charts");
        // Height and force; energy, its error, momentum, its error; rate; time step.
        assert_eq!(charts, 8);
        assert_eq!(of("data-sizes"), Some("1".repeat(charts)));
        assert_eq!(of("data-painted"), Some("1".repeat(charts)));
        // The cursor halfway along the axis of the third chart reads the time; a click on a name hides its line.
        let read: f64 = of("data-read").and_then(|text| text.parse().ok()).expect("a time");
        assert!((read - 2.0).abs() < 0.1, "{read} ms");
        assert_eq!(of("data-off"), Some("1".into()));
        // Static drawings for paper: three lines of energies, two of momenta.
        assert_eq!(of("data-drawn"), Some("1".repeat(charts + 3)));
        assert_eq!(of("data-loaded"), Some(String::new()));
        assert_eq!(of("data-pictures"), Some("111".into()));
        // Only tables, which scroll within their container, are wider than the window.
        assert_eq!(of("data-wide"), Some("0".into()), "{window}");
    }

    for (name, size, arguments) in [
        ("wide.png", "--window-size=1200,5200", [].as_slice()),
        ("narrow.png", "--window-size=420,8000", &[]),
        ("dark.png", "--window-size=1200,5200", &["--blink-settings=preferredColorScheme=0"]),
        ("narrow-dark.png", "--window-size=420,8000", &["--blink-settings=preferredColorScheme=0"]),
    ] {
        let shot = folder.0.join(name);
        let screenshot = format!("--screenshot={}", shot.display());
        let arguments = [&[size, screenshot.as_str()], arguments].concat();
        let looked = look(browser, &folder.0, &page, &arguments);
        assert!(looked.status.success(), "{}", String::from_utf8_lossy(&looked.stderr));
        let size = fs::metadata(&shot).map_or(0, |data| data.len());
        assert!(size > 50_000, "{name} has {size} bytes");
    }
    let bytes = |name: &str| fs::read(folder.0.join(name)).expect("a picture");
    assert_ne!(bytes("wide.png"), bytes("dark.png"), "light and dark look the same");
}
