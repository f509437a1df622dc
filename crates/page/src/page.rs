//! The open files and runs, and the dispatch of messages.

use std::collections::BTreeMap;

use crate::answer::{self, Answer, ok};
use crate::between::{self, Between, Lent, WHOLE};
use crate::language;
use crate::merge::merge;
use crate::overview::overview;
use crate::places::inward;
use crate::prove::{self, Proof};
use crate::redrawn::Shown;
use crate::request::Request;
use crate::run::{self, Run};
use crate::{drawing, edit, export, testing};
use g7_ide::File;
use g7_ide::gestures;
use g7_model::Language;

/// A page: its open files and its runs.
#[derive(Default)]
pub struct Page {
    files: BTreeMap<String, File>,
    runs: BTreeMap<String, Run>,
    /// The answers found so far, by file.
    proofs: BTreeMap<String, Proof>,
    shown: Shown,
    language: Language,
}

/// Greatest number of open files, and of runs.
const MOST: usize = 64;

impl Page {
    /// A page without files and runs.
    pub fn new() -> Page {
        Page::default()
    }

    /// Answers a message with `{"ok":…}` or with `{"no":"a sentence for the user"}`.
    pub fn call(&mut self, message: &str) -> String {
        let answer = match serde_json::from_str(message) {
            Ok(request) => self.here_or_there(request),
            Err(e) => match serde_json::from_str(message) {
                Ok(between) => self.between(between),
                Err(_) => Err(format!("this message means nothing: {e}")),
            },
        };
        answer::text(answer)
    }

    fn answer(&mut self, request: Request) -> Answer {
        match request {
            Request::Open { file, text } => self.open(file, text),
            Request::Close { file } => {
                self.files.remove(&file);
                self.proofs.remove(&file);
                self.shown.forget(&file);
                ok(&())
            }
            Request::Speak { language, words } => {
                // A program with its own texts takes none from a client.
                if let Some(words) = words.filter(|_| cfg!(target_arch = "wasm32")) {
                    g7_model::said::teach(words);
                }
                self.language = Language::of(&language).unwrap_or_default();
                for file in self.files.values_mut() {
                    file.language = self.language;
                }
                ok(&())
            }
            Request::Look { file } => self.look(&file),
            Request::Text { file } => ok(&serde_json::json!({ "text": self.file(&file)?.text() })),
            Request::Splice { file, splices, unit } => {
                let open = self.file_mut(&file)?;
                let splices = inward(open, &splices);
                open.change(&splices, !unit)?;
                self.look(&file)
            }
            Request::Edit { file, gesture } => ok(&edit::edit(&file, self.file_mut(&file)?, &gesture)?),
            Request::Undo { file } => ok(&edit::travel(&file, self.file_mut(&file)?, true)?),
            Request::Redo { file } => ok(&edit::travel(&file, self.file_mut(&file)?, false)?),
            Request::Format { file } => ok(&edit::format(&file, self.file_mut(&file)?)?),
            Request::References { file, at } => ok(&language::references(self.file(&file)?, at)),
            Request::Copy { file, ids } => {
                let text = gestures::copy(self.file(&file)?, &ids);
                ok(&serde_json::json!({ "text": text }))
            }
            Request::Merge { base, mine, theirs } => ok(&merge(&base, &mine, &theirs)?),
            Request::Drawing(wish) => {
                let drawn = drawing::drawing(self.file(&wish.file)?, &wish)?;
                self.shown.answer(&wish, drawn, |redrawn| ok(redrawn))
            }
            Request::Forms => {
                if !WHOLE {
                    return between::not_here();
                }
                ok(&export::forms())
            }
            Request::Export { file, to } => {
                if !WHOLE {
                    return between::not_here();
                }
                ok(&export::export(&file, self.file(&file)?, &to)?)
            }
            Request::Logic { file, id } => ok(&language::logic(self.file(&file)?, &id)?),
            Request::LogicRead { tongue, text } => {
                ok(&serde_json::json!({ "text": language::logic_read(tongue, &text)? }))
            }
            Request::Style { dark } => ok(&serde_json::json!({ "css": g7_draw::style(dark) })),
            Request::Test { file, name } => ok(&testing::test(self.file(&file)?, name.as_deref())?),
            Request::Prove { file, limits } => self.prove(&file, limits),
            Request::ProveWays { file, wish } => {
                if !WHOLE {
                    return between::not_here();
                }
                ok(&prove::ways(self.file(&file)?, &wish)?)
            }
            Request::Compare(wish) => {
                if !WHOLE {
                    return between::not_here();
                }
                let [a, b] = &wish.files;
                ok(&prove::compared([self.file(a)?, self.file(b)?], &wish)?)
            }
            Request::Before { file } => ok(&serde_json::json!({ "text": self.file(&file)?.before() })),
            Request::Tokens { file, from, to } => ok(&language::tokens(self.file(&file)?, from, to)),
            Request::Complete { file, at } => ok(&language::complete(self.file(&file)?, at)),
            Request::Hover { file, at } => ok(&language::hover(self.file(&file)?, at)),
            Request::Symbols { file } => ok(&language::tables(self.file(&file)?)),
            Request::Search { file, text } => ok(&language::search(self.file(&file)?, &text)),
            Request::RunStart(wish) => self.start(&wish),
            Request::RunStop { run } => {
                self.runs.remove(&run);
                ok(&())
            }
            Request::RunAdvance { run, ms, most_scans, times } => {
                self.with(&run, times, |r| r.advance(ms, most_scans))
            }
            Request::RunScan { run, times } => self.with(&run, times, Run::one_scan),
            Request::RunPass { run, times } => self.with(&run, times, Run::pass),
            Request::RunSet { run, signal, value } => self.with(&run, false, |r| r.set(signal, &value)),
            Request::RunToggle { run, signal } => self.with(&run, false, |r| r.toggle(signal)),
            Request::RunForce { run, signal, value } => self.with(&run, false, |r| r.force(signal, &value)),
            Request::RunRelease { run, signal } => self.with(&run, false, |r| match signal {
                Some(signal) => r.release(signal),
                None => r.release_all(),
            }),
            Request::RunRestart { run, warm } => self.with(&run, true, |r| r.restart(warm)),
            Request::RunSeek { run, ms } => self.with(&run, true, |r| r.seek(ms)),
            Request::RunLive { run, here } => self.with(&run, true, |r| {
                r.live(here);
                Ok(())
            }),
            Request::RunBreaks { run, ids } => {
                let run = self.run(&run)?;
                run.set_breaks(&ids);
                ok(&serde_json::json!({ "ids": run.break_ids() }))
            }
            Request::RunSwap { run, file, force } => self.swap(&run, &file, force),
            Request::RunFrame { run, full, times } => ok(&self.run(&run)?.frame(full, times)),
            Request::RunSignals { run } => ok(&self.run(&run)?.started()),
            Request::RunLanes { run, signals, from_ms, to_ms, most } => {
                ok(&self.run(&run)?.lanes(&signals, from_ms, to_ms, most))
            }
            Request::RunExport { run, signals, r#as, from_ms, to_ms } => {
                let text = self.run(&run)?.export(&signals, r#as, from_ms, to_ms)?;
                ok(&serde_json::json!({ "text": text }))
            }
        }
    }

    /// Answers a request, or says that the other module does.
    fn here_or_there(&mut self, request: Request) -> Answer {
        let names = request.files();
        match self.answer(request) {
            Err(no) if no == between::ELSEWHERE => {
                let lent = names.iter().map(|name| Ok(Lent::new(name, self.file(name)?)));
                between::elsewhere("about", lent.collect::<Result<_, String>>()?)
            }
            Err(no) if no == between::FOREIGN => between::elsewhere("import", Vec::new()),
            answer => answer,
        }
    }

    /// Answers a message that comes from the other module.
    fn between(&mut self, message: Between) -> Answer {
        match message {
            Between::About { files, ask } => {
                if !WHOLE {
                    return between::not_here();
                }
                let mut page = Page { language: self.language, ..Page::default() };
                for lent in files {
                    let file = lent.file(page.language)?;
                    page.files.insert(lent.file, file);
                }
                page.answer(ask)
            }
            Between::Import { ask } => {
                if !WHOLE {
                    return between::not_here();
                }
                ok(&between::import(ask, self.language)?)
            }
            Between::Imported(imported) => {
                let (name, file) = imported.file()?;
                self.put(name, file)
            }
        }
    }

    fn file(&self, name: &str) -> Result<&File, String> {
        self.files.get(name).ok_or_else(|| format!("{name} is not open"))
    }

    fn file_mut(&mut self, name: &str) -> Result<&mut File, String> {
        self.files.get_mut(name).ok_or_else(|| format!("{name} is not open"))
    }

    fn run(&mut self, name: &str) -> Result<&mut Run, String> {
        self.runs.get_mut(name).ok_or_else(|| format!("there is no run `{name}`"))
    }

    fn open(&mut self, name: String, text: String) -> Answer {
        let file = between::open(&name, text)?;
        self.put(name, file)
    }

    fn put(&mut self, name: String, mut file: File) -> Answer {
        if self.files.len() >= MOST && !self.files.contains_key(&name) {
            return Err("too many files are open: close one".to_owned());
        }
        file.language = self.language;
        let name = if file.imported { with_ending(&name) } else { name };
        self.files.insert(name.clone(), file);
        self.look(&name)
    }

    fn look(&self, name: &str) -> Answer {
        ok(&overview(name, self.file(name)?))
    }

    fn prove(&mut self, name: &str, limits: prove::Limits) -> Answer {
        if !WHOLE {
            return between::not_here();
        }
        let known = self.proofs.remove(name);
        let (proof, report) = prove::prove(self.file(name)?, known, limits);
        self.proofs.insert(name.to_owned(), proof);
        ok(&report)
    }

    fn start(&mut self, wish: &run::Start) -> Answer {
        if self.runs.len() >= MOST && !self.runs.contains_key(&wish.run) {
            return Err("too many runs: stop one".to_owned());
        }
        let mut run = run::start(&self.file(&wish.file)?.source, wish)?;
        let started = ok(&run.started());
        self.runs.insert(wish.run.clone(), run);
        started
    }

    /// Continues a run with a changed text: answers with the losses, or with the description of the
    /// new run.
    fn swap(&mut self, run: &str, file: &str, force: bool) -> Answer {
        let open = self.files.get(file).ok_or_else(|| format!("{file} is not open"))?;
        let run = self.runs.get_mut(run).ok_or_else(|| format!("there is no run `{run}`"))?;
        let lost = run.swap(&open.source, force)?;
        if lost.is_empty() { ok(&run.started()) } else { ok(&serde_json::json!({ "lost": lost })) }
    }

    /// Does something with a run and answers with what changed.
    fn with(&mut self, name: &str, times: bool, work: impl FnOnce(&mut Run) -> Result<(), String>) -> Answer {
        let run = self.run(name)?;
        work(run)?;
        ok(&run.frame(false, times))
    }
}

/// The name of an imported file: its own name with the extension .g7.
fn with_ending(name: &str) -> String {
    let stem = name.rsplit_once('.').filter(|(_, end)| !end.contains('/')).map_or(name, |(stem, _)| stem);
    format!("{stem}.g7")
}
