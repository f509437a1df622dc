//! The open files and runs, and the answers to messages.

use std::collections::BTreeMap;
use std::sync::Arc;

use g7_edit::{Gesture, ItemId, Joined};
use g7_ide::gestures;
use g7_ide::{File, Texts};
use g7_model::{Language, Said, say};
use g7_rig::named;

use crate::answer::{self, Answer, Before, Breaks, Shelved, Style, Text, ok, shelf, shelved};
use crate::between::{self, Between, Lent, WHOLE};
use crate::edit::{self, Edited, Foreseen};
use crate::exercise;
use crate::export::{self, Form, Out};
use crate::language::{self, ActionForm, Coloured, Completion, Hit, Hover, Piece, Tables, Tongue};
use crate::merge::{Merged, merge};
use crate::overview::{Overview, overview};
use crate::picture::{self, PlantPicture};
use crate::places::{Change, inward};
use crate::printed::{self, Printed};
use crate::prove::{self, Proof};
use crate::redrawn::{Redrawn, Shown};
use crate::request::{Answers, Request};
use crate::run::{self, Asked, Because, Frame, Lanes, Run, Started, Swapped};
use crate::{drawing, sheet, testing};

/// A page: its open files and its runs.
#[derive(Default)]
pub struct Page {
    files: BTreeMap<String, File>,
    runs: BTreeMap<String, Run>,
    /// The answers found so far, by file.
    proofs: BTreeMap<String, Proof>,
    shown: Shown,
    language: Language,
    /// The texts of files that open files use, as they are on the disk; `None` for a file that is not there.
    texts: BTreeMap<String, Option<Arc<str>>>,
    goes_on: Option<GoesOn>,
}

/// Asked after each scan of a message: false ends its scans, however many are due.
type GoesOn = Box<dyn FnMut() -> bool + Send>;

fn not_open(file: &str) -> Said {
    say!("{} is not open", Said::foreign(file))
}

/// True if one of the files uses the file of this name.
fn is_used(files: &BTreeMap<String, File>, name: &str) -> bool {
    files.iter().any(|(head, file)| file.uses.iter().any(|path| named(head, path) == name))
}

fn no_run(name: &str) -> Said {
    say!("there is no run `{name}`")
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
        let answer = match serde_json::from_str::<Request>(message) {
            Ok(request) => self.here_or_there(request),
            Err(e) => match serde_json::from_str(message) {
                Ok(between) => self.between(between),
                Err(_) => Err(Said::foreign(format!("this message means nothing: {e}"))),
            },
        };
        answer::text(answer.map_err(|no| no.in_language(self.language)))
    }

    /// The same, for a caller who cannot wait for all scans that are due: they end after the one at which `goes_on` says
    /// no, and the run is late. One scan is made in any case.
    pub fn call_while(&mut self, message: &str, goes_on: impl FnMut() -> bool + Send + 'static) -> String {
        self.goes_on = Some(Box::new(goes_on));
        let answer = self.call(message);
        self.goes_on = None;
        answer
    }

    /// Answers a request, or says that the other module does.
    fn here_or_there(&mut self, request: Request) -> Answer {
        let names = request.files();
        match self.answer(request) {
            Err(no) if &*no == between::ELSEWHERE => {
                let lent = names.iter().map(|name| Ok(Lent::new(name, self.file(name)?)));
                between::elsewhere("about", lent.collect::<Result<_, Said>>()?)
            }
            Err(no) if &*no == between::FOREIGN => between::elsewhere("import", Vec::new()),
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
                    let name = lent.file.clone();
                    page.files.insert(name, lent.file(page.language)?);
                }
                page.answer(*ask)
            }
            Between::Import { ask } => {
                if !WHOLE {
                    return between::not_here();
                }
                ok(&between::import(ask, self.language)?)
            }
            Between::Imported(imported) => {
                let (name, file) = imported.file()?;
                ok(&self.put(name, file)?)
            }
        }
    }

    /// Takes a file among those that are open.
    fn put(&mut self, name: String, mut file: File) -> Result<Overview, Said> {
        if self.files.len() >= MOST && !self.files.contains_key(&name) {
            return Err(say!("too many files are open; close one"));
        }
        file.language = self.language;
        let name = if file.imported { with_ending(&name) } else { name };
        self.files.insert(name.clone(), file);
        self.shelve(&name);
        self.look(name)
    }

    fn file(&self, name: &str) -> Result<&File, Said> {
        self.files.get(name).ok_or_else(|| not_open(name))
    }

    fn file_mut(&mut self, name: &str) -> Result<&mut File, Said> {
        self.files.get_mut(name).ok_or_else(|| not_open(name))
    }

    fn run(&mut self, name: &str) -> Result<&mut Run, Said> {
        self.runs.get_mut(name).ok_or_else(|| no_run(name))
    }

    /// The text of a file is new: lends it to the open files that use it, and those that it uses to the file.
    fn shelve(&mut self, name: &str) {
        let wants = self.files.get(name).is_some_and(|f| f.wants().next().is_some());
        if wants || is_used(&self.files, name) {
            self.lend_all();
        }
    }

    /// Gives each open file the texts of the files that it uses. Of a file that is open, this is the edited text, otherwise
    /// the text on the disk.
    fn lend_all(&mut self) {
        // A file that was lent may use another one.
        for _ in 0..MOST {
            let text = |name: String| match self.files.get(&name) {
                Some(open) => Some(Some(Arc::from(open.text()))),
                None => self.texts.get(&name).cloned(),
            };
            let texts = |head: &str, file: &File| -> Texts {
                file.uses.iter().filter_map(|path| Some((path.clone(), text(named(head, path))?))).collect()
            };
            let all: Vec<Texts> = self.files.iter().map(|(head, file)| texts(head, file)).collect();
            let mut changed = false;
            for (file, texts) in self.files.values_mut().zip(all) {
                changed |= file.lend(texts);
            }
            if !changed {
                break;
            }
        }
    }

    /// Executes a change of the history.
    fn travel(&mut self, name: &str, back: bool) -> Result<Edited, Said> {
        let edited = edit::travel(name, self.file_mut(name)?, back)?;
        self.shelve(name);
        Ok(edited)
    }

    /// Does something with a run and answers with what changed.
    fn with(
        &mut self,
        name: &str,
        times: bool,
        work: impl FnOnce(&mut Run) -> Result<(), Said>,
    ) -> Result<Frame, Said> {
        let run = self.run(name)?;
        work(run)?;
        Ok(run.frame(false, times))
    }
}

impl Answers for Page {
    fn open(&mut self, name: String, text: String, uses: Option<Vec<Shelved>>) -> Result<Overview, Said> {
        let mut file = between::open(&name, text)?;
        file.lend(shelf(uses));
        self.put(name, file)
    }

    fn used(&mut self, file: String) -> Result<Vec<Shelved>, Said> {
        Ok(shelved(self.file(&file)?))
    }

    fn close(&mut self, file: String) -> Result<(), Said> {
        self.files.remove(&file);
        self.proofs.remove(&file);
        self.shown.forget(&file);
        // The disk may have another text: those that use it ask again.
        self.texts.remove(&file);
        self.texts.retain(|name, _| is_used(&self.files, name));
        for (head, other) in &mut self.files {
            let path = other.uses.iter().find(|path| named(head, path) == file).cloned();
            path.into_iter().for_each(|path| other.forget(&path));
        }
        Ok(())
    }

    fn lend(&mut self, files: Vec<Shelved>) -> Result<(), Said> {
        self.texts.extend(shelf(Some(files)));
        self.lend_all();
        Ok(())
    }

    fn speak(&mut self, language: String, words: Option<String>) -> Result<(), Said> {
        // A program with its own texts takes none from a client.
        if let Some(words) = words.filter(|_| cfg!(target_arch = "wasm32")) {
            g7_model::said::teach(words);
        }
        self.language = Language::of(&language).unwrap_or_default();
        for file in self.files.values_mut() {
            file.language = self.language;
        }
        for run in self.runs.values_mut() {
            run.language = self.language;
        }
        Ok(())
    }

    fn look(&mut self, file: String) -> Result<Overview, Said> {
        Ok(overview(&file, self.file(&file)?))
    }

    fn text(&mut self, file: String) -> Result<Text, Said> {
        Ok(Text { text: self.file(&file)?.text().to_owned() })
    }

    fn splice(
        &mut self,
        file: String,
        splices: Vec<Change>,
        unit: bool,
        others: bool,
    ) -> Result<Overview, Said> {
        let open = self.file_mut(&file)?;
        let splices = inward(open, &splices);
        if others {
            open.change_of_others(&splices)?;
        } else {
            open.change(&splices, !unit)?;
        }
        self.shelve(&file);
        self.look(file)
    }

    fn edit(&mut self, file: String, gesture: Gesture) -> Result<Edited, Said> {
        let edited = edit::edit(&file, self.file_mut(&file)?, &gesture)?;
        self.shelve(&file);
        Ok(edited)
    }

    fn foresee(&mut self, file: String, gesture: Gesture) -> Result<Foreseen, Said> {
        Ok(edit::foresee(self.file(&file)?, &gesture))
    }

    fn mend(&mut self, file: String, version: u64, problem: usize, fix: usize) -> Result<Edited, Said> {
        let edited = edit::mend(&file, self.file_mut(&file)?, version, (problem, fix))?;
        self.shelve(&file);
        Ok(edited)
    }

    fn action_form(
        &mut self,
        text: String,
        qualifier: Option<String>,
        time: Option<String>,
    ) -> Result<ActionForm, Said> {
        Ok(language::action_form(&text, qualifier.as_deref(), time, self.language))
    }

    fn undo(&mut self, file: String) -> Result<Edited, Said> {
        self.travel(&file, true)
    }

    fn redo(&mut self, file: String) -> Result<Edited, Said> {
        self.travel(&file, false)
    }

    fn joins(&mut self, file: String, ids: Vec<ItemId>) -> Result<Vec<Joined>, Said> {
        gestures::joins(self.file(&file)?, &ids)
    }

    fn copy(&mut self, file: String, ids: Vec<ItemId>) -> Result<Text, Said> {
        Ok(Text { text: gestures::copy(self.file(&file)?, &ids) })
    }

    fn merge(&mut self, base: String, mine: String, theirs: String) -> Result<Merged, Said> {
        if !WHOLE {
            return between::not_here();
        }
        merge(&base, &mine, &theirs)
    }

    fn format(&mut self, file: String) -> Result<Edited, Said> {
        let edited = edit::format(&file, self.file_mut(&file)?)?;
        self.shelve(&file);
        Ok(edited)
    }

    fn references(&mut self, file: String, at: usize) -> Result<Vec<(usize, usize)>, Said> {
        Ok(language::references(self.file(&file)?, at))
    }

    fn drawing(&mut self, wish: drawing::Wish) -> Result<Redrawn<'_>, Said> {
        let drawn = sheet::drawn(self.file(&wish.file)?, &wish)?;
        Ok(self.shown.answer(&wish, drawn))
    }

    fn forms(&mut self) -> Result<Vec<Form>, Said> {
        if !WHOLE {
            return between::not_here();
        }
        Ok(export::forms())
    }

    fn export(&mut self, file: String, to: String) -> Result<Out, Said> {
        if !WHOLE {
            return between::not_here();
        }
        export::export(&file, self.file(&file)?, &to)
    }

    fn sheets(&mut self, file: String, wish: printed::Wish) -> Result<Printed, Said> {
        if !WHOLE {
            return between::not_here();
        }
        printed::print(self.file(&file)?, wish)
    }

    fn plant_picture(&mut self, file: String, plant: String) -> Result<PlantPicture, Said> {
        if !WHOLE {
            return between::not_here();
        }
        picture::picture(self.file(&file)?, &plant)
    }

    fn logic(&mut self, file: String, id: String, tongue: Tongue) -> Result<Vec<Piece>, Said> {
        if WHOLE {
            return language::logic(self.file(&file)?, &id, tongue);
        }
        if tongue == Tongue::St {
            return language::structured(self.file(&file)?, &id);
        }
        between::not_here()
    }

    fn logic_read(&mut self, tongue: Tongue, text: String) -> Result<Text, Said> {
        if !WHOLE {
            return between::not_here();
        }
        Ok(Text { text: language::logic_read(tongue, &text)? })
    }

    fn style(&mut self, dark: bool) -> Result<Style, Said> {
        Ok(Style { css: g7_draw::style(dark) })
    }

    fn test(&mut self, file: String, name: Option<String>) -> Result<testing::Report, Said> {
        if !WHOLE {
            return between::not_here();
        }
        testing::test(self.file(&file)?, name.as_deref())
    }

    fn test_why(&mut self, file: String, name: String) -> Result<testing::Reasons, Said> {
        if !WHOLE {
            return between::not_here();
        }
        testing::why(self.file(&file)?, &name)
    }

    fn prove(&mut self, file: String, limits: prove::Limits) -> Result<prove::Report, Said> {
        if !WHOLE {
            return between::not_here();
        }
        let known = self.proofs.remove(&file);
        let (proof, report) = prove::prove(self.file(&file)?, known, limits);
        self.proofs.insert(file, proof);
        Ok(report)
    }

    fn prove_ways(&mut self, file: String, wish: prove::Wish) -> Result<prove::Ways, Said> {
        if !WHOLE {
            return between::not_here();
        }
        prove::ways(self.file(&file)?, &wish)
    }

    fn compare(&mut self, wish: prove::Both) -> Result<prove::Compared, Said> {
        if !WHOLE {
            return between::not_here();
        }
        let [a, b] = &wish.files;
        prove::compared([self.file(a)?, self.file(b)?], &wish)
    }

    fn exercise_pack(&mut self, folder: String, files: Vec<Shelved>) -> Result<exercise::Packed, Said> {
        if !WHOLE {
            return between::not_here();
        }
        Ok(exercise::pack(&folder, files, self.language))
    }

    fn exercise_check(&mut self, work: exercise::Work) -> Result<exercise::Checked, Said> {
        if !WHOLE {
            return between::not_here();
        }
        exercise::check(work, self.language)
    }

    fn before(&mut self, file: String) -> Result<Before, Said> {
        Ok(Before { text: self.file(&file)?.before() })
    }

    fn tokens(&mut self, file: String, from: usize, to: usize) -> Result<Vec<Coloured>, Said> {
        Ok(language::tokens(self.file(&file)?, from, to))
    }

    fn complete(&mut self, file: String, at: usize) -> Result<Completion, Said> {
        Ok(language::complete(self.file(&file)?, at))
    }

    fn hover(&mut self, file: String, at: usize) -> Result<Option<Hover>, Said> {
        Ok(language::hover(self.file(&file)?, at))
    }

    fn symbols(&mut self, file: String) -> Result<Tables, Said> {
        Ok(language::tables(self.file(&file)?))
    }

    fn search(&mut self, file: String, text: String) -> Result<Vec<Hit>, Said> {
        Ok(language::search(self.file(&file)?, &text))
    }

    fn run_start(&mut self, wish: run::Start) -> Result<Started, Said> {
        if self.runs.len() >= MOST && !self.runs.contains_key(&wish.run) {
            return Err(say!("there are too many runs; stop one"));
        }
        let mut run = run::start(&self.file(&wish.file)?.source, &wish, self.language)?;
        let started = run.started();
        self.runs.insert(wish.run, run);
        Ok(started)
    }

    fn run_advance(
        &mut self,
        run: String,
        ms: f64,
        most_scans: Option<u32>,
        times: bool,
    ) -> Result<Frame, Said> {
        let mut goes_on = self.goes_on.take();
        let goes_on = || goes_on.as_mut().is_none_or(|goes_on| goes_on());
        self.with(&run, times, |r| r.advance(ms, most_scans, goes_on))
    }

    fn run_scan(&mut self, run: String, times: bool) -> Result<Frame, Said> {
        self.with(&run, times, Run::one_scan)
    }

    fn run_pass(&mut self, run: String, times: bool) -> Result<Frame, Said> {
        self.with(&run, times, Run::pass)
    }

    fn run_set(&mut self, run: String, signal: usize, value: String) -> Result<Frame, Said> {
        self.with(&run, false, |r| r.set(signal, &value))
    }

    fn run_toggle(&mut self, run: String, signal: usize) -> Result<Frame, Said> {
        self.with(&run, false, |r| r.toggle(signal))
    }

    fn run_force(&mut self, run: String, signal: usize, value: String) -> Result<Frame, Said> {
        self.with(&run, false, |r| r.force(signal, &value))
    }

    fn run_release(&mut self, run: String, signal: Option<usize>) -> Result<Frame, Said> {
        self.with(&run, false, |r| match signal {
            Some(signal) => r.release(signal),
            None => r.release_all(),
        })
    }

    fn run_restart(&mut self, run: String, warm: bool) -> Result<Frame, Said> {
        self.with(&run, true, |r| r.restart(warm))
    }

    fn run_seek(&mut self, run: String, ms: f64) -> Result<Frame, Said> {
        self.with(&run, true, |r| r.seek(ms))
    }

    fn run_live(&mut self, run: String, here: bool) -> Result<Frame, Said> {
        self.with(&run, true, |r| {
            r.live(here);
            Ok(())
        })
    }

    fn run_breaks(&mut self, run: String, ids: Vec<String>) -> Result<Breaks, Said> {
        let run = self.run(&run)?;
        run.set_breaks(&ids);
        Ok(Breaks { ids: run.break_ids() })
    }

    fn run_swap(&mut self, run: String, file: String, force: bool) -> Result<Swapped, Said> {
        let open = self.files.get(&file).ok_or_else(|| not_open(&file))?;
        let run = self.runs.get_mut(&run).ok_or_else(|| no_run(&run))?;
        let lost = run.swap(&open.source, force)?;
        if lost.is_empty() {
            return Ok(Swapped::Started(Box::new(run.started())));
        }
        Ok(Swapped::Lost { lost: lost.iter().map(|l| l.in_language(self.language)).collect() })
    }

    fn run_stop(&mut self, run: String) -> Result<(), Said> {
        self.runs.remove(&run);
        Ok(())
    }

    fn run_frame(&mut self, run: String, full: bool, times: bool) -> Result<Frame, Said> {
        Ok(self.run(&run)?.frame(full, times))
    }

    fn run_signals(&mut self, run: String) -> Result<Started, Said> {
        Ok(self.run(&run)?.started())
    }

    fn run_lanes(
        &mut self,
        run: String,
        signals: Vec<usize>,
        from_ms: f64,
        to_ms: f64,
        most: usize,
    ) -> Result<Lanes, Said> {
        Ok(self.run(&run)?.lanes(&signals, from_ms, to_ms, most))
    }

    fn run_tape(&mut self, run: String) -> Result<Text, Said> {
        Ok(Text { text: self.run(&run)?.record()? })
    }

    fn why(&mut self, asked: Asked) -> Result<Because, Said> {
        if !WHOLE {
            return between::not_here();
        }
        run::why(asked, self.language)
    }

    fn run_export(
        &mut self,
        run: String,
        signals: Vec<usize>,
        form: run::Form,
        from_ms: Option<f64>,
        to_ms: Option<f64>,
    ) -> Result<Text, Said> {
        Ok(Text { text: self.run(&run)?.export(&signals, form, from_ms, to_ms)? })
    }
}

/// The name of an imported file: its own name with the extension .g7.
fn with_ending(name: &str) -> String {
    let stem = name.rsplit_once('.').filter(|(_, end)| !end.contains('/')).map_or(name, |(stem, _)| stem);
    format!("{stem}.g7")
}
