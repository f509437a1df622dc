//! Files that several people edit at once.

use super::*;

/// The text in the examples of this file: the letter behind `a` takes two UTF-16 units.
const TEXT: &str = "a\u{1F600}b";

async fn join(page: &mut Live, name: &str, edits: bool, text: &str) -> Value {
    let call =
        json!({ "do": "together_join", "file": "chart.g7", "name": name, "text": text, "edits": edits });
    page.call(call).await
}

/// A change of the text of a version.
fn change(version: u64, from: usize, to: usize, insert: &str) -> Value {
    let splices = json!([{ "from": from, "to": to, "insert": insert }]);
    let key = format!("{version} {from} {to} {}", insert.len());
    json!({ "do": "together_change", "file": "chart.g7", "version": version, "splices": splices, "key": key })
}

fn names(people: &Value) -> Vec<&str> {
    people.as_array().expect("people").iter().map(|p| p["name"].as_str().expect("a name")).collect()
}

#[tokio::test]
async fn a_change_of_the_newest_version_is_made_by_all_and_any_other_waits() {
    let server = Server::new().await;
    let (mut ana, mut ben) = (server.live().await, server.live().await);
    let first = join(&mut ana, "Ana", true, TEXT).await;
    assert_eq!((&first["version"], &first["text"], &first["edits"]), (&json!(1), &json!(TEXT), &json!(true)));
    let second = join(&mut ben, "Ben", true, "another text").await;
    assert_eq!((&second["version"], &second["text"]), (&json!(1), &json!(TEXT)), "the text that is there");
    assert_eq!(names(&second["people"]), ["Ana", "Ben"]);

    assert_eq!(ana.call(change(1, 3, 4, "c")).await, json!({ "version": 2 }));
    assert_eq!(ben.call(change(1, 0, 0, "x")).await, json!({ "behind": true }));
    let told = ben.hear_of("together").await;
    assert_eq!(
        told["change"],
        json!({
            "version": 2, "by": first["me"], "splices": [{ "from": 3, "to": 4, "insert": "c" }],
        })
    );
    assert_eq!(ben.call(change(2, 0, 0, "x")).await, json!({ "version": 3 }));

    // Whoever comes back is told which of its changes was made before its connection broke.
    for (key, made) in [("2 0 0 1", true), ("1 0 0 1", false)] {
        let call = json!({
            "do": "together_join", "file": "chart.g7", "name": "Ben", "edits": true, "text": "", "key": key,
        });
        assert_eq!(ben.call(call).await["made"], made, "{key}");
    }

    let mut eva = server.live().await;
    let third = join(&mut eva, "Eva", true, "").await;
    assert_eq!((&third["version"], &third["text"]), (&json!(3), &json!("xa\u{1F600}c")));
    assert_eq!(server.on_disk("chart.g7"), CHART, "nothing is written by this");
}

#[tokio::test]
async fn a_change_that_fits_no_text_is_refused_and_changes_nothing() {
    let server = Server::new().await;
    let mut ana = server.live().await;
    join(&mut ana, "Ana", true, TEXT).await;
    for (from, to) in [(3, 9), (9, 9), (3, 2), (0, 2), (2, 3)] {
        let no = ana.no(change(1, from, to, "")).await;
        assert_eq!(no, "these places are none of the text", "{from}..{to}");
    }
    let long = "x".repeat(900_000);
    ana.call(change(1, 0, 0, &long)).await;
    let no = ana.no(change(2, 0, 0, &long)).await;
    assert_eq!(no, "a text that several people edit has at most 1048576 letters");
    assert_eq!(ana.call(change(2, 0, 900_000, "")).await, json!({ "version": 3 }));
    assert_eq!(join(&mut server.live().await, "Ben", true, "").await["text"], TEXT);
    let stranger = server.live().await.no(change(3, 0, 0, "x")).await;
    assert_eq!(stranger, "only who edits a file together with others may change it");
    for call in [
        json!({ "do": "together_join", "file": "f", "name": "a\nb", "edits": true }),
        json!({ "do": "together_join", "file": "f".repeat(2_000), "name": "", "edits": true }),
        json!({ "do": "together_here", "file": "chart.g7", "here": { "select": vec!["x"; 65] } }),
    ] {
        assert_eq!(ana.no(call).await, "this message is too long for what it means");
    }
    let no = ana.no(json!({ "do": "together_leave" })).await;
    assert!(no.starts_with("this message means nothing"), "{no}");
}

#[tokio::test]
async fn everyone_is_told_who_is_there_and_where() {
    let server = Server::new().await;
    let (mut ana, mut ben) = (server.live().await, server.live().await);
    let me = join(&mut ana, "Ana", true, TEXT).await["me"].clone();
    join(&mut ben, "Ben", false, "").await;
    assert_eq!(names(&ana.hear_of("together").await["people"]), ["Ana", "Ben"]);
    let here = json!({ "chart": "G", "point": [1.5, 2.0], "select": ["step G 1"], "text": [0, 1] });
    ana.call(json!({ "do": "together_here", "file": "chart.g7", "here": here })).await;
    assert_eq!(ben.hear_of("together").await["here"], json!([[me, here]]));
    let tables = server.live().await.call(json!({ "do": "together_list" })).await;
    assert_eq!(tables["tables"][0]["file"], "chart.g7");
    assert_eq!(names(&tables["tables"][0]["people"]), ["Ana", "Ben"]);

    // A connection that breaks counts as leaving, and the text goes with the last one who edits.
    drop(ana);
    assert_eq!(names(&ben.hear_of("together").await["people"]), ["Ben"]);
    let mut eva = server.live().await;
    assert_eq!(join(&mut eva, "Eva", true, "new").await["text"], "new");
    let told = ben.hear_of("together").await;
    assert_eq!(told["begun"], json!({ "version": 2, "text": "new" }), "who looks gets the text");
    eva.call(json!({ "do": "together_saved", "file": "chart.g7", "tag": "abc" })).await;
    while ben.hear_of("together").await.get("saved") != Some(&json!("abc")) {}
}

#[tokio::test]
async fn a_guest_looks_and_changes_nothing() {
    let server = Server::new().await;
    let (mut ana, mut guest) = (server.live().await, server.guest().await);
    join(&mut ana, "Ana", true, TEXT).await;
    let joined = join(&mut guest, "Gil", true, "theirs").await;
    assert_eq!((&joined["edits"], &joined["text"]), (&json!(false), &json!(TEXT)));
    assert_eq!(guest.no(change(1, 0, 0, "x")).await, "only who may write files may change this one");
    assert_eq!(ana.call(change(1, 0, 1, "x")).await, json!({ "version": 2 }));
    assert_eq!(guest.hear_of("together").await["change"]["version"], 2, "it hears of changes");

    let by = async |method: &str, path: &str, headers: &[(&str, &str)]| {
        server.ask_by(&server.guest, method, path, headers, "{}").await.status
    };
    assert_eq!(by("GET", "/api/file?path=chart.g7", &[]).await, 200);
    assert_eq!(by("PUT", "/api/file?path=chart.g7", &[("If-Match", "*")]).await, 403);
    assert_eq!(by("POST", "/api/new", &[]).await, 403);
    assert_eq!(by("POST", "/api/delete", &[]).await, 403);
    assert_eq!(by("GET", "/api/draft?window=a&id=b", &[]).await, 403);
    let no = guest.no(json!({ "do": "run_start", "run": "a", "file": "chart.g7" })).await;
    assert!(no.contains("needs the role `operator`"), "{no}");
    let session = server.ask_by(&server.guest, "GET", "/api/session", &[], "").await.json();
    assert_eq!((&session["guest"], &session["user"]["role"]), (&json!(true), &json!("viewer")));
    assert_eq!(server.get("/api/session").await.json()["guest"], false);
}

#[tokio::test]
async fn in_a_folder_for_looking_nobody_edits() {
    let server = Server::with(|args| args.read_only = true, Limits::default()).await;
    let mut ana = server.live().await;
    assert_eq!(join(&mut ana, "Ana", true, TEXT).await["edits"], false);
    assert_eq!(ana.no(change(0, 0, 0, "x")).await, "only who may write files may change this one");
}
