//! Several processes that want the same lease, and leases that expire.

use super::holder::EXPIRY;
use super::*;
use crate::base::digest::Digest;
use crate::encode::output::Output;
use std::time::SystemTime;

const NAME: &str = ".kinora-claim-0";

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
}

fn age(path: &Path, by: Duration) {
    let file = File::options().write(true).open(path).expect("a lease");
    file.set_modified(SystemTime::now() - by).expect("a lease");
}

#[test]
fn one_of_several_processes_acquires_a_lease() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join(NAME);
    let (leases, got) = (Leases::new(), AtomicU64::new(0));
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| {
                for _ in 0..20 {
                    if let Ok(lease) = leases.acquire(&path).expect("a disk") {
                        assert_eq!(got.fetch_add(1, Relaxed), 0, "two have it");
                        got.fetch_sub(1, Relaxed);
                        drop(lease);
                    }
                }
            });
        }
    });
    assert_eq!(names(dir.path()), Vec::<String>::new());
}

#[test]
fn a_lease_names_its_holder() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join(NAME);
    let leases = Leases::new();
    let lease = leases.acquire(&path).expect("a disk").expect("free");
    let found = leases.acquire(&path).expect("a disk").expect_err("taken");
    assert_eq!(found.process, Some(Process::this()));
    assert!(found.idle < EXPIRY && !found.is_gone());
    assert_eq!(names(dir.path()), [NAME]);
    drop(lease);
    assert_eq!(holder(&path).expect("a disk"), None);
}

#[test]
fn only_void_leases_are_taken_over() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join(NAME);
    let leases = Leases::new();
    let there = |text: &str, idle: u64| {
        fs::write(&path, text).expect("a disk");
        age(&path, Duration::from_secs(idle));
        leases.acquire(&path).expect("a disk").is_ok()
    };
    let elsewhere = "elsewhere boot 1 1\n0\n";
    assert!(!there(elsewhere, 60) && there(elsewhere, 300));
    // A lease without a process expires like any other.
    assert!(!there("", 60) && there("", 300));
    #[cfg(target_os = "linux")]
    {
        let this = Process::this().to_string();
        let ended = this.rsplit_once(' ').expect("words").0.to_owned() + " 1\n0\n";
        assert!(there(&ended, 0));
    }
    assert_eq!(names(dir.path()), Vec::<String>::new());
}

/// A process that was suspended for too long does not remove the lease of its successor.
#[test]
fn lost_leases_are_not_removed() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join(NAME);
    let (first, second) = (Leases::new(), Leases::new());
    let lost = first.acquire(&path).expect("a disk").expect("free");
    // The file system's clock goes in steps.
    age(&path, 2 * EXPIRY);
    let taken = second.acquire(&path).expect("a disk").expect("void");
    drop(lost);
    assert!(first.acquire(&path).expect("a disk").is_err());
    drop(taken);
    assert!(names(dir.path()).is_empty());
}

#[test]
fn a_valid_lease_is_put_back() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join(NAME);
    fs::write(&path, "new").expect("a disk");
    let before = LeaseHolder { process: None, idle: EXPIRY, text: "old".to_owned() };
    remove_void(&path, &before).expect("a disk");
    assert!(has_text(&path, "new"));
    remove_void(&path, &LeaseHolder { text: "new".to_owned(), ..before }).expect("a disk");
    assert!(names(dir.path()).is_empty());
}

#[test]
fn touched_leases_stay_valid() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join(NAME);
    let leases = Leases::new();
    let lease = leases.acquire(&path).expect("a disk").expect("free");
    age(&path, EXPIRY);
    lock(&leases.held).values_mut().for_each(|file| touch(file).expect("a disk"));
    let found = holder(&path).expect("a disk").expect("a lease");
    assert!(found.idle < HEARTBEAT && found.text == lease.text, "{found:?}");
}

#[test]
fn leases_are_for_films_of_an_output() {
    let output = |name: &str| Output::parse(name).expect(name);
    let path = |name: &str, film: u128| path_of(&output(name), Digest(film));
    assert_eq!(path("a/f_##.png", 1), path("a/f_%02d.png", 1));
    assert_ne!(path("a/f_##.png", 1), path("a/f_##.png", 2));
    assert_ne!(path("a/f_##.png", 1), path("a/g_##.png", 1));
    let one = path("a/f_##.png", 1);
    assert_eq!(one.parent(), Some(Path::new("a")));
    assert_eq!(one.file_name(), path("b/f_##.png", 1).file_name());
    assert!(is_lease(&one.file_name().expect("a name").to_string_lossy()));
    assert!(!is_lease(".kinora-abcdef.part"));
}
