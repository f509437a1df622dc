//! `crowd ADDRESS PAGES SECONDS`: so many pages watch a controller for so long. The address is the one that
//! `g7 serve --online` prints. The last line says how many entered and how many frames a second each got.

use std::process::ExitCode;
use std::time::Duration;

use g7_peers::crowd::Crowd;

fn main() -> ExitCode {
    match watch() {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(why) => {
            eprintln!("crowd: {why}");
            ExitCode::FAILURE
        }
    }
}

fn watch() -> Result<String, String> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [address, pages, seconds] = &words[..] else { return Err("ADDRESS PAGES SECONDS".to_owned()) };
    let of_page = address.strip_prefix("http://").and_then(|rest| rest.split_once("/operator?token="));
    let (host, token) = of_page.ok_or("the address is not that of an operator's page")?;
    let host = host.parse().map_err(|e| format!("{host}: {e}"))?;
    let pages: u64 = pages.parse().map_err(|e| format!("{pages}: {e}"))?;
    let seconds: u64 = seconds.parse().map_err(|e| format!("{seconds}: {e}"))?;
    let crowd = Crowd::enter(host, token, pages, 0).map_err(|e| e.to_string())?;
    let pause = Duration::from_millis(50);
    while crowd.entered().0 + crowd.entered().1 < pages {
        std::thread::sleep(pause);
    }
    let before = crowd.frames();
    std::thread::sleep(Duration::from_secs(seconds));
    let each = (crowd.frames() - before) as f64 / pages.max(1) as f64 / seconds.max(1) as f64;
    let (entered, refused) = crowd.entered();
    Ok(format!(
        "{entered} pages, {refused} refused, {} closed; {each:.1} frames a second each",
        crowd.closed()
    ))
}
