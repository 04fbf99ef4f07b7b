//! Stress tests: kills, damaged checkpoints, random scenes, a busy machine. A few of each in every test run; ten times as many with another
//! seed, which takes minutes:
//!
//! `IMPACTITE_SEED=7 IMPACTITE_ATTACKS=10 cargo test --release -p impactite-cli --test attack -- --include-ignored`
#![cfg(unix)]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

/// Random number generator (splitmix64).
struct Numbers(u64);

impl Numbers {
    /// Create the random numbers of an attack from the seed of the environment.
    fn new(attack: u64) -> Self {
        let seed = std::env::var("IMPACTITE_SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(1u64);
        Numbers(seed.wrapping_mul(1000) + attack)
    }
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    fn below(&mut self, n: usize) -> usize {
        (self.word() % n.max(1) as u64) as usize
    }
    fn of<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }
    /// Random number from a to b.
    fn real(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * (self.word() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Number of attacks: `few` times the factor of the environment.
fn attacks(few: usize) -> usize {
    few * std::env::var("IMPACTITE_ATTACKS").ok().and_then(|s| s.parse().ok()).unwrap_or(1)
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("impactite-attack-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn impactite(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_impactite"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// Return exit code and output of a program; panic unless it ends by itself with one of its exit codes.
fn orderly(command: &mut Command, what: &str) -> (i32, String) {
    let Output { status, stdout, stderr } = command.output().expect("the program");
    let said = String::from_utf8_lossy(&stdout).to_string() + &String::from_utf8_lossy(&stderr);
    let code = status.code().unwrap_or_else(|| panic!("{what}: ended by a signal: {said}"));
    assert!(!said.contains("panicked") && (0..=2).contains(&code), "{what}: {code}: {said}");
    (code, said)
}

const FALL: &str = r#"
title = "Two discs"
space = "plane strain"
end = "3 ms"
contact.law.friction = 0.3
method.mpm = { cell = "1 mm" }
materials.rubber.neo_hookean = { density = "1 g/cm^3", young = "1 MPa", poisson = 0.4 }
conditions = [{ wall = { axis = "y", at = 0 } }]
[bodies.lower]
material = "rubber"
shape.ball = { centre = [0, "10 mm"], radius = "10 mm" }
[bodies.upper]
material = "rubber"
shape.ball = { centre = ["3 mm", "31 mm"], radius = "10 mm" }
velocity = [0, "-5 m/s"]
[measures]
height = { centre = { body = "upper", axis = "y" } }
force = { contact_force = { between = ["upper", "lower"], axis = "y" } }
[output]
pictures = "1 ms"
"#;

#[test]
fn kills_change_no_bit() {
    let (at, mut numbers) = (folder("kills"), Numbers::new(1));
    let scene = at.join("scene.toml");
    std::fs::write(&scene, FALL).expect("a file");
    let path = |p: &Path| p.to_str().expect("a text").to_string();
    let whole = at.join("whole");
    let begun = std::time::Instant::now();
    assert_eq!(
        orderly(
            &mut impactite(&["run", &path(&scene), "--out", &path(&whole), "--checkpoint", "0.02"]),
            "whole"
        )
        .0,
        0
    );
    let long = begun.elapsed().as_millis() as usize;
    let same = |out: &Path, file: &str| {
        std::fs::read(whole.join(file)).unwrap() == std::fs::read(out.join(file)).unwrap()
    };
    let mut kills = 0;
    while kills < attacks(10) {
        let out = at.join(format!("run-{kills}"));
        let mut arguments = vec![
            "run".to_string(),
            path(&scene),
            "--out".into(),
            path(&out),
            "--checkpoint".into(),
            "0.02".into(),
        ];
        loop {
            let list: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let mut child: Child =
                impactite(&list).stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program");
            std::thread::sleep(Duration::from_millis(numbers.below(long + 20) as u64));
            let signal = numbers.of(&["KILL", "INT", "TERM"]);
            if child.try_wait().expect("its state").is_none() {
                kills += 1;
                let _ = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
            }
            child.wait().expect("its end");
            if out.join("result.json").exists() {
                break;
            }
            arguments = if out.join("run.checkpoint").exists() {
                vec!["resume".into(), path(&out), "--checkpoint".into(), "0.02".into()]
            } else {
                vec![
                    "run".to_string(),
                    path(&scene),
                    "--out".into(),
                    path(&out),
                    "--checkpoint".into(),
                    "0.02".into(),
                ]
            };
        }
        for file in ["measures.csv", "pictures/scene_000001.png", "paraview/scene_000008.vtp"] {
            assert!(same(&out, file), "another {file} after {kills} kills");
        }
        let parts = ["", "pictures", "paraview"].iter().flat_map(|f| std::fs::read_dir(out.join(f)).unwrap());
        let parts: Vec<_> =
            parts.flatten().filter(|e| e.file_name().to_string_lossy().ends_with(".part")).collect();
        assert!(parts.is_empty(), "{parts:?}");
        std::fs::remove_dir_all(&out).expect("the folder");
    }
    std::fs::remove_dir_all(at).expect("the folder");
}

#[test]
fn damaged_checkpoints_are_refused() {
    let (at, mut numbers) = (folder("checkpoints"), Numbers::new(2));
    std::fs::write(at.join("scene.toml"), FALL.replace("1 mm\"", "2 mm\"")).expect("a file");
    let out = at.join("run").to_str().expect("a text").to_string();
    let scene = at.join("scene.toml").to_str().expect("a text").to_string();
    orderly(&mut impactite(&["run", &scene, "--out", &out, "--no-pictures", "--keep-checkpoint"]), "whole");
    let file = at.join("run/run.checkpoint");
    let sound = std::fs::read(&file).expect("a checkpoint");
    for n in 0..attacks(20) {
        let mut bytes = sound.clone();
        let place = numbers.below(bytes.len());
        match n % 4 {
            0 => bytes.truncate(place),
            1 => bytes[place] ^= 1 << numbers.below(8),
            2 => bytes
                .splice(place..place, (0..8).map(|_| numbers.word() as u8).collect::<Vec<_>>())
                .for_each(drop),
            _ => {
                let end = (place + 1 + numbers.below(64)).min(bytes.len());
                (place..end).for_each(|i| bytes[i] = numbers.word() as u8);
            }
        }
        std::fs::write(&file, &bytes).expect("a file");
        let (code, said) = orderly(&mut impactite(&["resume", &out]), "a damaged checkpoint");
        assert!(code == 2 && said.contains("error:"), "change {n} at {place}: {code}: {said}");
    }
    std::fs::write(&file, &sound).expect("a file");
    assert_eq!(orderly(&mut impactite(&["resume", &out]), "the sound one").0, 0);
    std::fs::remove_dir_all(at).expect("the folder");
}

/// Generate a random scene of one to three bodies with numbers of plausible magnitude.
fn random_scene(numbers: &mut Numbers) -> String {
    let space = numbers.of(&["plane strain", "plane strain", "axisymmetric", "3d"]);
    let dimensions = if space == "3d" { 3 } else { 2 };
    let method = numbers.of(&["mpm", "mpm", "mpm", "sph", "fem", "fpm", "pcmm"]);
    let size = 10f64.powf(numbers.real(-3.0, 1.0));
    let cells = numbers.real(3.0, if dimensions == 3 { 5.0 } else { 9.0 });
    let spacing = size / cells;
    let options = match method {
        "mpm" => format!(
            "cell = {spacing}, for = \"{}\"",
            numbers.of(&["impact", "contact at rest", "machine parts", "large elastic"])
        ),
        "fem" => String::new(),
        _ => format!("spacing = {spacing}"),
    };
    let young = 10f64.powf(numbers.real(5.0, 11.5));
    let density = numbers.real(500.0, 9000.0);
    let waves = (young / density).sqrt();
    let material = match numbers.below(4) {
        0 => format!(
            "neo_hookean = {{ density = {density}, young = {young}, poisson = {} }}",
            numbers.real(0.0, 0.48)
        ),
        1 => format!(
            "elastic = {{ density = {density}, young = {young}, poisson = {} }}",
            numbers.real(-0.2, 0.49)
        ),
        2 => format!("library = \"{}\"", numbers.of(&["copper_taylor", "lead", "aluminium_6061_t6"])),
        _ => "library = \"copper_taylor\"".into(),
    };
    let (first, up) = if space == "axisymmetric" { ("r", "z") } else { ("x", "y") };
    let vector = |list: &[f64]| format!("{:?}", &list[..dimensions]);
    let mut text = format!(
        "title = \"random\"\nspace = \"{space}\"\nend = {}\nmethod.{method} = {{ {options} }}\nmaterials.m.{material}\n",
        numbers.real(0.5, 3.0) * size / waves.max(300.0)
    );
    text += numbers.of(&[
        "contact.law.friction = 0.3\n",
        "contact.law.friction = 0\n",
        "contact.law.stick = {}\n",
    ]);
    match numbers.below(4) {
        0 => text += &format!("conditions = [{{ wall = {{ axis = \"{up}\", at = 0, friction = 0.2 }} }}]\n"),
        1 => text += &format!("conditions = [{{ symmetry = {{ axis = \"{first}\", at = 0 }} }}]\n"),
        2 => text += &format!("conditions = [{{ fixed = {{ axis = \"{up}\", at = {} }} }}]\n", 0.3 * size),
        _ => text += &format!("gravity = {}\n", vector(&[0.0, -9.81, 0.0])),
    }
    for n in 0..1 + numbers.below(3) {
        let low = [0.0, n as f64 * 1.01 * size, 0.0];
        let high = [size * numbers.real(0.5, 1.5), low[1] + size, size * 0.7];
        let speed = waves * 10f64.powf(numbers.real(-4.0, -0.3));
        let velocity = if space == "axisymmetric" {
            [0.0, -speed * n as f64, 0.0]
        } else {
            [speed * 0.1, -speed * n as f64, 0.0]
        };
        text += &format!("[bodies.b{n}]\nmaterial = \"m\"\nvelocity = {}\n", vector(&velocity));
        text += &format!("shape.box = {{ from = {}, to = {} }}\n", vector(&low), vector(&high));
        if method == "fem" {
            text += &format!("mesh.edge = {spacing}\n");
        }
    }
    text + &format!("[measures]\nheight = {{ centre = {{ body = \"b0\", axis = \"{up}\" }} }}\n")
}

#[test]
fn random_scenes_end_in_order() {
    let (at, mut numbers) = (folder("scenes"), Numbers::new(3));
    let mut codes = [0; 3];
    for n in 0..attacks(30) {
        let text = random_scene(&mut numbers);
        let scene = at.join(format!("{n}.toml"));
        std::fs::write(&scene, &text).expect("a file");
        let out = at.join(format!("{n}")).to_str().expect("a text").to_string();
        let (code, said) = orderly(
            impactite(&["run", scene.to_str().expect("a text"), "--out", &out, "--json"]).args(["-q"]),
            &text,
        );
        codes[code as usize] += 1;
        if code == 2 {
            println!("{}", said.lines().find(|l| l.starts_with("error")).unwrap_or_default());
        } else {
            assert!(!said.to_lowercase().contains("nan"), "{text}\n{said}");
            let page = std::fs::read_to_string(Path::new(&out).join("report.html")).expect("a page");
            assert!(!page.contains("cannot be used"), "{text}");
        }
        let _ = std::fs::remove_dir_all(&out);
    }
    println!("exit codes 0, 1, 2: {codes:?}");
    assert!(2 * codes[0] > codes.iter().sum(), "{codes:?}");
    std::fs::remove_dir_all(at).expect("the folder");
}

/// Run checks at the lowest priority beside threads that occupy all processors.
#[test]
#[ignore = "takes all processors, which other tests need"]
fn a_busy_machine_refuses_no_scene() {
    let loops: Vec<Child> = (0..2 * std::thread::available_parallelism().map_or(2, usize::from))
        .map(|_| Command::new("sh").args(["-c", "while :; do :; done"]).spawn().expect("a loop"))
        .collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let (mut checked, mut refused) = (0, Vec::new());
    for _ in 0..attacks(1) {
        for entry in std::fs::read_dir(&folder).expect("the scenes").flatten() {
            let path = entry.path();
            if path.extension().is_none_or(|e| e != "toml") {
                continue;
            }
            let mut command = Command::new("nice");
            command.args(["-n", "19", env!("CARGO_BIN_EXE_impactite"), "check"]).arg(&path);
            let output = command.output().expect("the program");
            checked += 1;
            if !output.status.success() {
                refused.push(format!("{}: {}", path.display(), String::from_utf8_lossy(&output.stderr)));
            }
        }
    }
    for mut child in loops {
        let _ = child.kill();
        let _ = child.wait();
    }
    assert!(checked > 0 && refused.is_empty(), "{checked} checked; {refused:?}");
}
