//! The wiring of a chart: looked at, changed under the guard of its hash, and asked.

use std::io::{Read as _, Write as _};

use super::*;

const IO: &str = "\
# hall 3
[devices.line1]
kind = \"modbus-tcp\"
host = \"127.0.0.1\"   # here
port = 1
timeout = \"1s\"

[inputs]
a = \"line1.coil(7)\"  # the button
";

async fn look(server: &Server) -> Value {
    server.ask("POST", "/api/wiring/look", &[], r#"{"path":"chart.g7"}"#).await.is(200).json()
}

async fn edit(server: &Server, hash: &Value, changes: Value) -> Reply {
    let body = json!({ "path": "chart.g7", "hash": hash, "changes": changes });
    server.ask("POST", "/api/wiring/edit", &[], &body.to_string()).await
}

#[tokio::test]
async fn a_wiring_is_shown_with_what_is_wrong_at_its_row() {
    let server = Server::new().await;
    let nothing = look(&server).await;
    assert_eq!((&nothing["io"], &nothing["hash"]), (&json!("chart.io.toml"), &Value::Null));
    assert_eq!(nothing["signals"][0]["name"], "a");
    let words: Vec<&str> =
        nothing["kinds"].as_array().expect("kinds").iter().filter_map(|k| k["word"].as_str()).collect();
    assert_eq!(words, g7_online::setup::Kind::WORDS);
    fs::write(server.path("chart.io.toml"), IO.replace("coil(7)", "holding(7)")).expect("an io file");
    let told = look(&server).await;
    assert_eq!(told["devices"][0]["settings"]["port"], 1);
    assert_eq!(told["channels"]["inputs"][0]["variable"], "a");
    assert_eq!(told["problems"][0]["path"], json!(["inputs", "a"]));
    assert!(told["problems"][0]["help"].as_str().is_some_and(|help| help.contains("holding(4.0)")), "{told}");
}

#[tokio::test]
async fn a_change_leaves_the_rest_of_the_file_as_it_is() {
    let server = Server::new().await;
    let rows = json!([{ "do": "set", "path": ["devices", "desk"], "value": { "kind": "panel" } }]);
    let told = edit(&server, &Value::Null, rows).await.is(200).json();
    assert_eq!(server.on_disk("chart.io.toml"), "[devices.desk]\nkind = \"panel\"\n");
    // A file that is there is not begun anew.
    let wires = json!([{ "do": "set", "path": ["outputs", "m"], "value": "desk.lamp()" }]);
    edit(&server, &Value::Null, wires.clone()).await.is(412);
    let told = edit(&server, &told["hash"], wires).await.is(200).json();
    assert_eq!(
        (told["problems"].as_array().map(Vec::len), &told["channels"]["outputs"][0]["at"]),
        (Some(0), &json!("desk.lamp()"))
    );

    fs::write(server.path("chart.io.toml"), IO).expect("a change outside");
    let other = json!([{ "do": "set", "path": ["devices", "line1", "port"], "value": 1502 }]);
    let present = edit(&server, &told["hash"], other.clone()).await.is(412).json();
    assert_eq!(server.on_disk("chart.io.toml"), IO, "what somebody else wrote stays");
    edit(&server, &present["hash"], other).await.is(200);
    assert_eq!(server.on_disk("chart.io.toml"), IO.replace("port = 1\n", "port = 1502\n"));
    for wrong in [
        json!([{ "do": "set", "path": ["elsewhere", "x"], "value": 1 }]),
        json!([{ "do": "set", "path": ["inputs", "x"], "value": [1] }]),
        json!([{ "do": "what" }]),
    ] {
        edit(&server, &look(&server).await["hash"], wrong).await.is(400);
    }
}

#[tokio::test]
async fn a_server_that_only_reads_changes_no_wiring() {
    let server = Server::with(|args| args.read_only = true, Limits::default()).await;
    let change = json!([{ "do": "set", "path": ["devices", "desk"], "value": { "kind": "panel" } }]);
    edit(&server, &Value::Null, change).await.is(403);
    assert!(!server.path("chart.io.toml").exists());
    let outside = r#"{"path":"../secret.g7"}"#;
    server.ask("POST", "/api/wiring/look", &[], outside).await.is(400);
}

/// Answers one request of function 1 for the coil 7 after another; the connection ends at anything else.
fn slave() -> u16 {
    let listener = std::net::TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).expect("a port");
    let port = listener.local_addr().expect("an address").port();
    std::thread::spawn(move || {
        for stream in listener.incoming().take(3) {
            let Ok(mut stream) = stream else { return };
            let mut request = [0u8; 12];
            while stream.read_exact(&mut request).is_ok() {
                assert_eq!(&request[7..], [1, 0, 7, 0, 1], "it only reads");
                let answer = [request[0], request[1], 0, 0, 0, 4, request[6], 1, 1, 1];
                if stream.write_all(&answer).is_err() {
                    break;
                }
            }
        }
    });
    port
}

#[tokio::test]
async fn devices_are_asked_and_those_that_are_silent_are_told() {
    let server = Server::new().await;
    let live = r#"{"path":"chart.g7"}"#;
    let there = IO.replace("port = 1\n", &format!("port = {}\n", slave()));
    let both = there
        + "[devices.gone]\nkind = \"modbus-tcp\"\nhost = \"127.0.0.1\"\nport = 1\ntimeout = \"1s\"\n[devices.desk]\nkind = \"panel\"\n";
    fs::write(server.path("chart.io.toml"), both).expect("an io file");
    let told = server.ask("POST", "/api/wiring/live", &[], live).await.is(200).json();
    assert_eq!(told["values"]["a"], json!({ "value": "TRUE", "raw": "TRUE" }), "{told}");
    let devices = &told["devices"];
    assert_eq!(
        (&devices["line1"]["is"], &devices["gone"]["is"], &devices["desk"]["is"]),
        (&json!("answers"), &json!("silent"), &json!("panel"))
    );
    assert!(devices["line1"]["took_ms"].is_number() && devices["gone"]["why"].is_string(), "{told}");
    assert_eq!(told["hash"], look(&server).await["hash"]);
}

#[tokio::test]
async fn a_server_in_the_network_asks_no_device() {
    // It listens at this machine alone here; what counts is what it was told.
    let reached = |rules: &mut Rules| rules.host = Ipv4Addr::UNSPECIFIED.into();
    let server = Server::under(|_| {}, reached, Limits::default()).await;
    let told = server.ask("POST", "/api/wiring/live", &[], r#"{"path":"chart.g7"}"#).await.is(200).json();
    assert_eq!(told, json!({ "no": "reached" }));
}
