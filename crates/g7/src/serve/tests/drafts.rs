//! Unsaved work: it belongs to a window and a person, and nobody else deletes it.

use super::*;

/// The copies that a window is told of: path, holder and name.
async fn told(server: &Server, window: &str) -> Vec<(String, String, String)> {
    let list = server.get(&format!("/api/drafts?window={window}")).await.is(200).json();
    let rows = list["drafts"].as_array().expect("a list").clone();
    let text = |row: &Value, key: &str| row[key].as_str().expect("a text").to_owned();
    rows.iter().map(|row| (text(row, "path"), text(row, "holder"), text(row, "id"))).collect()
}

/// The same without their names.
async fn seen(server: &Server, window: &str) -> Vec<(String, String)> {
    told(server, window).await.into_iter().map(|(path, holder, _)| (path, holder)).collect()
}

fn all(rows: &[(&str, &str)]) -> Vec<(String, String)> {
    rows.iter().map(|(path, holder)| ((*path).to_owned(), (*holder).to_owned())).collect()
}

impl Server {
    async fn keep(&self, window: &str, path: &str, end: &str, text: &str) {
        let at = format!("/api/draft?window={window}&end={end}&path={path}");
        self.ask("PUT", &at, &[], text).await.is(204);
    }

    async fn window(&self, name: &str) -> Live {
        let address = format!("ws://{}/api/live?token={}&window={name}", self.bound, self.token);
        let stream = TcpStream::connect(self.bound).await.expect("a connection");
        let (socket, _) = tokio_tungstenite::client_async(address, stream).await.expect("a WebSocket");
        let mut live = Live { socket, next: 1, unread: Vec::new() };
        live.call(json!({ "do": "runs" })).await;
        live
    }

    /// Waits until the server has noticed that a window was closed.
    async fn has_left(&self, asks: &str) {
        while seen(self, asks).await.iter().any(|(_, holder)| holder == "other") {
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }
}

#[tokio::test]
async fn a_copy_is_not_taken_and_not_deleted_while_its_window_is_there() {
    let server = Server::new().await;
    let one = server.window("one").await;
    server.keep("one", "chart.g7", "open", "first").await;
    server.keep("one", "chart.g7", "open", "half a thought: é").await;
    assert_eq!(seen(&server, "one").await, all(&[("chart.g7", "this")]));
    let list = server.get("/api/drafts?window=one").await.json();
    assert_eq!(list["drafts"][0]["size"], "half a thought: é".len());
    let rows = told(&server, "two").await;
    let [(path, holder, id)] = rows.as_slice() else { panic!("{rows:?}") };
    assert_eq!((path.as_str(), holder.as_str()), ("chart.g7", "other"));
    // Another window saves and closes the same file, and asks for the copy in every way.
    server.ask("POST", "/api/draft/saved?window=two&path=chart.g7", &[], "").await.is(204);
    server.keep("two", "chart.g7", "closed", "mine").await;
    server.ask("POST", &format!("/api/draft/take?window=two&id={id}"), &[], "").await.is(409);
    server.ask("DELETE", &format!("/api/draft?window=two&id={id}"), &[], "").await.is(409);
    assert_eq!(server.get(&format!("/api/draft?id={id}")).await.json()["text"], "half a thought: é");
    drop(one);
    server.has_left("two").await;
    let taken = server.ask("POST", &format!("/api/draft/take?window=two&id={id}"), &[], "").await.is(200);
    assert_eq!(taken.json()["text"], "half a thought: é");
    // Taken once, it is not there for a third.
    server.ask("POST", &format!("/api/draft/take?window=three&id={id}"), &[], "").await.is(404);
    assert_eq!(fs::read_dir(server.path("")).expect("the folder").count(), 1, "none beside the sources");
}

#[tokio::test]
async fn what_is_closed_or_undone_can_be_had_back_and_what_is_saved_is_gone() {
    let server = Server::new().await;
    let _one = server.window("one").await;
    server.keep("one", "chart.g7", "open", "a").await;
    server.keep("one", "chart.g7", "closed", "a1").await;
    server.keep("one", "chart.g7", "open", "b").await;
    server.keep("one", "chart.g7", "undone", "b").await;
    assert_eq!(seen(&server, "two").await, all(&[("chart.g7", "closed"), ("chart.g7", "closed")]));
    server.keep("one", "chart.g7", "open", "c").await;
    let rows = told(&server, "two").await;
    assert_eq!(rows.len(), 2, "{rows:?}");
    let closed = rows.iter().find(|(_, holder, _)| holder == "closed").expect("it is kept");
    assert_eq!(server.get(&format!("/api/draft?id={}", closed.2)).await.json()["text"], "a1");
    server.ask("POST", "/api/draft/saved?window=one&path=chart.g7", &[], "").await.is(204);
    assert_eq!(seen(&server, "one").await, all(&[("chart.g7", "closed")]));
    server.ask("DELETE", &format!("/api/draft?window=two&id={}", closed.2), &[], "").await.is(204);
    assert_eq!(seen(&server, "one").await, []);
    for id in ["", "..", "..%2Fx", "a%2Fb", "x.json"] {
        server.ask("DELETE", &format!("/api/draft?window=two&id={id}"), &[], "").await.is(400);
    }
    for window in ["", "a-b", "%2E%2E", &"x".repeat(65)] {
        server.get(&format!("/api/drafts?window={window}")).await.is(400);
    }
}

/// The folder of the copies of a server.
fn kept(server: &Server) -> PathBuf {
    let folder = fs::read_dir(server.root.join("state/g7/drafts")).expect("copies").next();
    folder.expect("a folder").expect("a folder").path()
}

#[tokio::test]
async fn copies_outlive_the_server_and_closed_ones_are_kept_for_30_days() {
    let server = Server::new().await;
    let one = server.window("one").await;
    server.keep("one", "chart.g7", "open", "older").await;
    server.keep("three", "chart.g7", "open", "newer").await;
    server.keep("one", "not-there-yet.g7", "open", "new").await;
    let now = g7_host::utc_millis();
    let days = |n: u64| now - n * 24 * 3_600_000;
    for (id, at, closed) in [("a", days(29), true), ("b", days(31), true), ("c", days(400), false)] {
        let head = json!({ "path": format!("{id}.g7"), "window": "old", "at": at, "closed": closed });
        fs::write(kept(&server).join(format!("{id}.json")), format!("{head}\ntext")).expect("a copy");
    }
    // As earlier versions wrote it; and what is left of an interrupted write.
    fs::write(kept(&server).join("d.json"), r#"{"path":"d.g7","text":"as before"}"#).expect("a copy");
    fs::write(kept(&server).join(".x.json.1.new"), "{\"pa").expect("a torn file");
    fs::write(kept(&server).join("torn.json"), "{\"pa").expect("a torn file");
    // Another server of the same folder, as long as this one is there and when it has ended.
    let args = args_of(&server.root.join("charts"));
    let rules = Rules::of(&args, None, &crate::audit::Audit::default(), None).expect("they fit");
    let again = shared(&args, Limits::default(), Some(&server.root.join("state")), None, &rules)
        .expect("the same folder");
    let asks = crate::serve::drafts::Owner { person: String::new(), window: "two".to_owned() };
    let list = || serde_json::to_value(again.drafts.list(&asks)).expect("rows");
    let holders = |path: &str| {
        let rows = list();
        let rows = rows.as_array().expect("rows").iter().filter(|row| row["path"] == path);
        rows.map(|row| row["holder"].as_str().unwrap_or_default().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(holders("chart.g7"), ["other", "other"], "its server is there");
    assert_eq!((holders("a.g7"), holders("b.g7")), (vec!["closed".to_owned()], vec![]));
    assert_eq!((holders("c.g7"), holders("d.g7")), (vec!["gone".to_owned()], vec!["gone".to_owned()]));
    drop(one);
    let root = server.root.clone();
    server.task.abort();
    let shared_by_tasks = Arc::downgrade(&server.shared);
    fs::rename(root.join("state"), root.with_extension("state")).expect("moved");
    drop(server);
    fs::create_dir_all(&root).expect("a folder");
    fs::rename(root.with_extension("state"), root.join("state")).expect("moved back");
    while shared_by_tasks.strong_count() > 0 {
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    assert_eq!(holders("chart.g7"), ["gone", "gone"]);
    let newest = list().as_array().and_then(|rows| rows.iter().find(|r| r["path"] == "chart.g7").cloned());
    let id = newest.expect("a row")["id"].as_str().expect("a name").to_owned();
    assert_eq!(again.drafts.take(&asks, &id).expect("taken").text, "newer");
    // The older one is offered, and not opened by the next window.
    let mut now = holders("chart.g7");
    now.sort();
    assert_eq!(now, ["closed", "this"]);
    let old = again.drafts.take(&asks, "d").expect("taken");
    assert_eq!((old.path.as_str(), old.text.as_str()), ("d.g7", "as before"));
    fs::remove_dir_all(&root).ok();
}
