//! Passwords, roles and sessions: who is let in, for how long, and what ends it.

use std::path::PathBuf;

use super::*;

const PASSWORD: &str = "correct horse";

fn path(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("g7-users-{name}-{}", std::process::id()));
    std::fs::remove_dir_all(&folder).ok();
    std::fs::create_dir_all(&folder).expect("a folder");
    folder.join("users")
}

#[test]
fn a_user_is_known_by_name_and_password_alone() {
    let path = path("known");
    let users = Users::open(&path).expect("opened");
    assert!(!users.has_admin().expect("read"));
    users.add("Ana", Role::Admin, PASSWORD, 1, true).expect("added");
    assert!(users.has_admin().expect("read"));
    assert_eq!(users.check("ana", PASSWORD).expect("checked"), Some(("Ana".to_owned(), Role::Admin)));
    for (name, password) in [("Ana", "correct horsf"), ("Ana", ""), ("bob", PASSWORD), ("", "")] {
        assert_eq!(users.check(name, password).expect("checked"), None, "{name} {password}");
    }
    assert!(users.add("eve", Role::Admin, "another secret", 1, true).is_err(), "the first is there");
    let bytes =
        [std::fs::read(&path).expect("file"), std::fs::read(path.with_extension("-wal")).unwrap_or_default()];
    let text = String::from_utf8_lossy(&bytes.concat()).into_owned();
    assert!(!text.contains(PASSWORD));
}

#[test]
fn names_and_passwords_that_will_not_do_are_refused() {
    let users = Users::open(&path("fit")).expect("opened");
    for (name, password) in [
        ("", PASSWORD),
        ("a b", PASSWORD),
        ("a\n", PASSWORD),
        (&"n".repeat(41), PASSWORD),
        ("ana", "short"),
        ("ana", "ana-123456"),
        ("ana", "aaaaaaaaaaaaaaa"),
        ("ana", &"x1".repeat(300)),
    ] {
        assert!(
            matches!(users.add(name, Role::Viewer, password, 1, false), Err(UserError::Refused(_))),
            "{name}"
        );
    }
    users.add("ana", Role::Viewer, PASSWORD, 1, false).expect("added");
    assert!(
        users.add("ANA", Role::Viewer, PASSWORD, 1, false).is_err(),
        "letter case does not tell them apart"
    );
    assert!(users.add("joão.silva", Role::Viewer, PASSWORD, 1, false).is_ok());
}

#[test]
fn the_last_admin_stays() {
    let users = Users::open(&path("last")).expect("opened");
    users.add("ana", Role::Admin, PASSWORD, 1, true).expect("added");
    assert!(users.remove("ana").is_err() && users.set_role("ana", Role::Engineer).is_err());
    users.add("bob", Role::Admin, PASSWORD, 1, false).expect("added");
    users.set_role("ana", Role::Viewer).expect("changed");
    users.remove("ana").expect("removed");
    assert!(users.remove("bob").is_err() && users.remove("ana").is_err());
}

#[test]
fn each_change_of_a_user_ends_the_sessions() {
    let path = path("sessions");
    let users = Users::open(&path).expect("opened");
    users.add("ana", Role::Admin, PASSWORD, 1, true).expect("added");
    users.add("bob", Role::Viewer, PASSWORD, 1, false).expect("added");
    type Change = fn(&Users) -> Result<(), UserError>;
    let changes: [Change; 4] = [
        |users| users.revoke("bob"),
        |users| users.set_role("bob", Role::Operator),
        |users| users.set_password("bob", "another secret"),
        |users| users.remove("bob"),
    ];
    for change in changes {
        let secret = users.begin("bob", "127.0.0.1", 5).expect("begun");
        users.begin("ana", "127.0.0.1", 5).expect("begun");
        let of_bob = |s: &&Session| s.user == "bob";
        let all = users.sessions().expect("read");
        assert_eq!(all.iter().find(of_bob).map(|s| s.hash), Some(session_hash(&secret)));
        let before = users.version().expect("read");
        let of = |users: &Users| {
            let all = users.list().expect("read");
            all.into_iter().find(|user| user.name == "bob").map(|user| (user.created, user.changes))
        };
        let was = of(&users);
        change(&Users::open(&path).expect("another process")).expect("changed");
        assert_ne!(users.version().expect("read"), before);
        assert_ne!(of(&users), was);
        let all = users.sessions().expect("read");
        assert!(all.iter().all(|s| s.user == "ana") && !all.is_empty());
    }
    assert!(users.begin("bob", "127.0.0.1", 5).is_err());
    let hash = users.sessions().expect("read")[0].hash;
    users.touch(&hash, 9).expect("touched");
    assert_eq!(users.sessions().expect("read").iter().find(|s| s.hash == hash).map(|s| s.seen), Some(9));
    users.end(&hash).expect("ended");
    assert!(users.sessions().expect("read").iter().all(|s| s.hash != hash));
}

#[test]
fn a_file_of_the_first_layout_is_taken_over() {
    let path = path("layout");
    let old = file::open(&path, KIND, &LAYOUTS[..1], Durable::AtOnce).expect("made");
    let Kept { memory, passes, salt, hash } = Kept::of(PASSWORD).expect("hashed");
    let row = params!["ana", "admin", memory, passes, salt, hash, 1];
    old.execute("INSERT INTO user VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)", row).expect("written");
    drop(old);
    let users = Users::open(&path).expect("opened");
    assert_eq!(users.check("ana", PASSWORD).expect("checked"), Some(("ana".to_owned(), Role::Admin)));
    assert_eq!(users.list().expect("read")[0].changes, 0);
}
