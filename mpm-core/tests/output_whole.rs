//! Output files are complete or absent, whichever processes write to the same path and whatever fails.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

use mpm_core::geometry::{Cuboid, Filling, Lattice, fill};
use mpm_core::output::picture::Picture;
use mpm_core::output::vtk::write_vtp;
use mpm_core::output::{History, OutputError, ParticleSize, Snapshot, VtkOptions, write_whole};
use mpm_core::{BlockGrid, CheckpointError, Flip, Linear, Method, Mpm, Musl, PlaneStrain};
use mpm_materials::{LinearElastic, Moduli};

/// Folder of one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("impactite-whole-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a folder");
        Self(path)
    }
    /// Return the names of its files.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).expect("a folder").flatten();
        let mut names: Vec<String> = entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Create a block of so many cells an axis, and make some steps.
fn scene(cells: usize, steps: usize) -> Mpm<2> {
    let lattice = Lattice::new([0.0; 2], 0.1).expect("lattice");
    let shape = Cuboid::new([0.0; 2], [0.1 * cells as f64; 2]).expect("shape");
    let seeds = fill(&shape, &lattice, 2, &Filling::new()).expect("seeds");
    let law = LinearElastic::new(1000.0, Moduli::young_poisson(1e6, 0.3).expect("moduli")).expect("law");
    let mut mpm = Mpm::new(Method::new(Linear, Flip, Musl, PlaneStrain), BlockGrid::new(lattice));
    mpm.add("block", law, &seeds, |x| [0.1 * x[0], -0.2 * x[1]]).expect("body");
    for _ in 0..steps {
        mpm.step().expect("step");
    }
    mpm
}

fn snapshot(particles: usize) -> Snapshot {
    let positions = (0..particles).map(|i| [(i as f64).sin(), (i as f64).cos(), 0.0]).collect();
    Snapshot::new(2, 0.0, 0, positions, ParticleSize::Uniform(1e-3)).expect("snapshot")
}

/// Function that writes a file at a path, and returns the error message if it cannot.
type Writer = fn(&Path) -> Result<(), String>;

/// Return all writers, for files that are too large for a small disk.
fn writers() -> Vec<(&'static str, Writer)> {
    vec![
        ("checkpoint", |path| scene(20, 1).save(path).map_err(|e| e.to_string())),
        ("vtp", |path| write_vtp(path, &snapshot(20_000), VtkOptions::default()).map_err(|e| e.to_string())),
        ("png", |path| {
            let picture = Picture::new(3000, 2000, [10, 20, 30]).map_err(|e| e.to_string())?;
            picture.save(path).map_err(|e| e.to_string())
        }),
        ("text", |path| write_whole(path, vec![b'x'; 100_000]).map_err(|e| e.to_string())),
    ]
}

const SAVES: u64 = 200;

/// Environment variable with the path for a process that this test starts.
const PATH: &str = "IMPACTITE_TEST_WHOLE_PATH";

/// Task of the processes that the tests below start; otherwise no operation.
#[test]
fn another_process() {
    let Some(path) = std::env::var_os(PATH).map(PathBuf::from) else { return };
    if path.is_dir() {
        for (name, write) in writers() {
            let said = write(&path.join(name)).expect_err("a disk that is full");
            assert!(said.contains(&format!("cannot write `{}`", path.join(name).display())), "{said}");
        }
    } else {
        let mut mine = scene(4, 9);
        for _ in 0..SAVES {
            mine.save(&path).expect("saved");
        }
    }
}

/// Create a command that runs this test in another process.
fn process(path: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("this test"));
    command.args(["--exact", "another_process", "--nocapture"]).env(PATH, path);
    command
}

#[test]
fn who_reads_while_threads_and_processes_save_to_one_path_reads_one_of_them() {
    let folder = Folder::new("many");
    let path = folder.0.join("checkpoint");
    // Checkpoints of different lengths: a mixture would be detected.
    let steps = [3, 6, 9];
    scene(4, steps[0]).save(&path).expect("saved");
    let mut process = process(&path).spawn().expect("a process");
    let done = AtomicBool::new(false);
    let mut reads = 0;
    std::thread::scope(|scope| {
        let threads = [steps[0], steps[1]].map(|count| {
            let path = &path;
            scope.spawn(move || {
                let mut mine = scene(4, count);
                for _ in 0..SAVES {
                    mine.save(path).expect("saved");
                }
            })
        });
        let reader = scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                let found = scene(4, 0).resumed(&path).expect("a whole checkpoint");
                assert!(steps.iter().any(|&s| s as u64 == found.steps()), "{}", found.steps());
                reads += 1;
            }
        });
        let saved = threads.map(std::thread::ScopedJoinHandle::join);
        let other = process.wait().expect("its end");
        done.store(true, Ordering::Relaxed);
        reader.join().expect("every load is whole");
        assert!(saved.iter().all(Result::is_ok) && other.success());
    });
    println!("{reads} loads during {} saves", 3 * SAVES);
    assert!(reads > 0);
    assert_eq!(folder.names(), ["checkpoint"]);
}

#[cfg(unix)]
#[test]
fn a_link_stays_a_link() {
    use std::os::unix::fs::symlink;
    let folder = Folder::new("link");
    std::fs::create_dir(folder.0.join("there")).expect("a folder");
    let target = folder.0.join("there").join("file");
    // A link to a link, relative to its own folder; without a target at first.
    symlink("there/second", folder.0.join("first")).expect("a link");
    symlink("file", folder.0.join("there").join("second")).expect("a link");
    let link = folder.0.join("first");
    for (name, write) in writers() {
        write(&link).expect(name);
        let direct = folder.0.join("direct");
        write(&direct).expect(name);
        assert!(std::fs::read(&target).expect(name) == std::fs::read(&direct).expect(name), "{name}");
        assert!(link.symlink_metadata().expect(name).is_symlink(), "{name}");
    }
    let mut history = History::create(&link, [("time", "s")]).expect("created");
    history.push(&[1.0]).expect("a row");
    assert_eq!(std::fs::read_to_string(&target).expect("a file"), "time [s]\n1\n");
    assert!(link.symlink_metadata().expect("a link").is_symlink());
    symlink("round", folder.0.join("round")).expect("a link");
    let said = write_whole(folder.0.join("round"), "x").expect_err("refused").to_string();
    assert!(said.contains("round`") && said.contains("it is a symbolic link without an end"), "{said}");
    assert_eq!(folder.names(), ["direct", "first", "round", "there"]);
    assert_eq!(std::fs::read_dir(folder.0.join("there")).expect("a folder").count(), 2);
}

#[test]
fn what_is_no_regular_file_is_refused() {
    let folder = Folder::new("refused");
    let allowed = "which is not allowed; it must be a regular file, a link to one, or free";
    let check = |path: &Path, found: &str| {
        let expected = format!("cannot write `{}`: it is {found}, {allowed}", path.display());
        for (_, write) in writers() {
            assert_eq!(write(path).expect_err("refused"), expected);
        }
        assert_eq!(History::create(path, [("time", "s")]).expect_err("refused").to_string(), expected);
        let refused = scene(2, 0).save(path);
        assert!(matches!(refused, Err(CheckpointError::File(OutputError::NoFile { .. }))), "{refused:?}");
    };
    check(&folder.0, "a folder");
    check(Path::new(""), "the name of no file");
    #[cfg(unix)]
    {
        check(Path::new("/dev/null"), "a device");
        let link = folder.0.join("null");
        std::os::unix::fs::symlink("/dev/null", &link).expect("a link");
        check(&link, "a device");
        let socket = folder.0.join("socket");
        let _held = std::os::unix::net::UnixListener::bind(&socket).expect("a socket");
        check(&socket, "a socket");
        assert_eq!(folder.names(), ["null", "socket"]);
    }
}

/// Simulate a full disk: a limit of a few blocks for files of this process, with the signal that would end it ignored.
#[cfg(unix)]
#[test]
fn a_write_that_fails_leaves_nothing_behind_and_the_old_file() {
    let folder = Folder::new("full");
    for (name, _) in writers() {
        std::fs::write(folder.0.join(name), "old").expect("written");
    }
    let before = folder.names();
    let own = process(&folder.0);
    let mut shell = Command::new("sh");
    shell
        .args(["-c", "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\""])
        .arg(own.get_program())
        .args(own.get_args());
    let said = shell.env(PATH, &folder.0).output().expect("a shell");
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stdout));
    assert_eq!(folder.names(), before);
    for name in before {
        assert_eq!(std::fs::read_to_string(folder.0.join(&name)).expect("read"), "old", "{name}");
    }
}
