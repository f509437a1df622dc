//! Io files, refusals of printers, files and last lines in French and Portuguese.
#![allow(missing_docs, reason = "a test")]

use crate::common;

use common::{Folder, Ran};

const CHART: &str = "input a : BOOL\noutput q : BOOL\nchart Main {\n    initial step 0 { N q }\n    0 -> 1 when a\n    \
                     step 1\n    1 -> 0 when not a\n}\n";

fn folder(files: &[(&str, &str)]) -> Folder {
    let folder = Folder::new();
    files.iter().for_each(|(name, text)| folder.write(name, text));
    folder
}

/// A command in a language, whatever the surroundings say.
fn told(folder: &Folder, args: &[&str], lang: &str) -> Ran {
    folder.command(&[args, &["--lang", lang]].concat()).env("LC_ALL", "C").assert().into()
}

#[test]
fn a_broken_io_file_is_told_in_each_language() {
    let folder = folder(&[
        ("chart.g7", CHART),
        (
            "chart.io.toml",
            "[devices.line1]\nkind = \"modbus-tcp\"\nhost = 5\n[inputs]\nb = \"line1.coil(0)\"\n",
        ),
    ]);
    for (lang, host, input) in [
        ("en", "`host` of the device line1 is a text in quotes", "the chart has no input `b`"),
        (
            "fr",
            "l’équipement line1 : `host` est un texte entre guillemets",
            "le grafcet n’a pas d’entrée `b`",
        ),
        ("pt", "o equipamento line1: `host` é um texto entre aspas", "o grafcet não tem a entrada `b`"),
    ] {
        let ran = told(&folder, &["devices", "chart.g7"], lang);
        let all = ran.out.clone() + &ran.err;
        assert!(all.contains(host) && all.contains(input), "{lang}: {all}");
    }
}

#[test]
fn a_printer_refuses_in_each_language() {
    let folder = folder(&[("chart.g7", CHART)]);
    for (lang, way) in [
        ("en", "a search for stability, which is a loop, cannot be printed as Ladder"),
        (
            "fr",
            "une recherche de stabilité, qui est une boucle, ne peut pas être imprimée en schéma à contacts",
        ),
        (
            "pt",
            "uma procura de estabilidade, que é um ciclo, não pode ser impressa como diagrama de contactos",
        ),
    ] {
        let ran = told(&folder, &["gen", "ld", "chart.g7"], lang);
        assert!(ran.err.contains(way), "{lang}: {}", ran.err);
        ran.is(1);
    }
}

#[test]
fn a_file_that_is_missing_or_in_the_way_is_told_in_each_language() {
    let folder = folder(&[("chart.g7", CHART), ("there.g7", CHART)]);
    for (lang, missing) in [
        ("en", "error: cannot read none.g7: no such file or directory"),
        ("fr", "impossible de lire none.g7 : ce fichier ou ce dossier n’existe pas"),
        ("pt", "não foi possível ler none.g7: não existe tal ficheiro ou pasta"),
    ] {
        let ran = told(&folder, &["check", "none.g7"], lang);
        assert!(ran.err.contains(missing), "{lang}: {}", ran.err);
        ran.is(2);
    }
    for (lang, there) in [
        ("fr", "there.g7 existe, et g7 ne l’a pas écrit ; --force le remplace"),
        ("pt", "there.g7 existe, e não foi o g7 que o escreveu; --force substitui-o"),
    ] {
        let ran = told(&folder, &["draw", "chart.g7", "--as", "svg", "-o", "there.g7"], lang);
        assert!(ran.err.contains(there), "{lang}: {}", ran.err);
        ran.is(2);
    }
}

#[test]
fn the_last_line_is_told_in_each_language() {
    let test = format!("{CHART}test \"starts\" {{\n    expect q\n}}\n");
    let folder = folder(&[
        ("fine.g7", CHART),
        ("tested.g7", &test),
        ("bad.g7", "chart A {\n    step 1 { N foo }\n}\n"),
    ]);
    for (lang, fine, bad, tested) in [
        ("en", "1 file: no problems", "1 file: ", "1 passed, 0 failed"),
        ("fr", "1 fichier : aucun problème", "1 fichier : ", "tests réussis : 1, échoués : 0"),
        ("pt", "1 ficheiro: nenhum problema", "1 ficheiro: ", "testes com êxito: 1, falhados: 0"),
    ] {
        assert!(told(&folder, &["check", "fine.g7"], lang).err.contains(fine), "{lang}");
        let ran = told(&folder, &["check", "bad.g7"], lang);
        let (error, more) = match lang {
            "fr" => ("erreur", "`g7 explain CODE` en dit plus"),
            "pt" => ("erro", "`g7 explain CODE` diz mais"),
            _ => ("error", "`g7 explain CODE` says more"),
        };
        assert!([bad, error, more].iter().all(|part| ran.err.contains(part)), "{lang}: {}", ran.err);
        assert!(told(&folder, &["test", "tested.g7"], lang).out.contains(tested), "{lang}");
    }
}

#[test]
fn a_failed_test_is_told_in_each_language() {
    let test = format!("{CHART}test \"starts\" {{\n    expect not q\n}}\n");
    let folder = folder(&[("tested.g7", &test)]);
    for (lang, what, place) in [
        ("en", "expected: not q", "at tested.g7:10:12, 0s after the start"),
        ("fr", "attendu", "à tested.g7:10:12, 0s après le début"),
        ("pt", "esperado", "em tested.g7:10:12, 0s após o início"),
    ] {
        let ran = told(&folder, &["test", "tested.g7"], lang);
        assert!(ran.out.contains(what) && ran.out.contains(place), "{lang}: {}", ran.out);
        ran.is(1);
    }
}

#[test]
fn answers_and_what_was_written_are_told_in_each_language() {
    let folder = folder(&[("chart.g7", CHART), ("claim.g7", &format!("{CHART}prove never q\n"))]);
    for (lang, refuted, counted, wrote) in [
        ("en", "refuted: prove never q", "1 refuted, 0 not decided", "wrote chart-en.svg"),
        ("fr", "réfuté", "1 réfutées, 0 non décidées", "écrit chart-fr.svg"),
        ("pt", "refutado", "1 refutadas, 0 não decididas", "escrito chart-pt.svg"),
    ] {
        let ran = told(&folder, &["prove", "claim.g7"], lang);
        assert!(ran.out.contains(refuted) && ran.out.contains(counted), "{lang}: {}", ran.out);
        let to = format!("chart-{lang}.svg");
        let ran = told(&folder, &["draw", "chart.g7", "-o", &to], lang);
        assert!(ran.err.contains(wrote), "{lang}: {}", ran.err);
    }
}

#[test]
fn users_and_certificates_are_told_in_each_language() {
    let folder = folder(&[("chart.g7", CHART), ("cert.pem", "none"), ("key.pem", "none")]);
    for (lang, short, pem) in [
        ("en", "a password has at least 10 letters", "cert.pem has no certificate (PEM)"),
        ("fr", "un mot de passe a au moins 10 lettres", "cert.pem n’a pas de certificat (PEM)"),
        ("pt", "uma palavra-passe tem pelo menos 10 letras", "cert.pem não tem certificado (PEM)"),
    ] {
        let add = ["users", "add", "g7.users", "ana", "admin", "--lang", lang];
        let ran: Ran = folder.command(&add).env("LC_ALL", "C").stdin("short\n").assert().into();
        assert!(ran.err.contains(short), "{lang}: {}", ran.err);
        let tls = ["serve", "--no-open", "--port", "0", "--cert", "cert.pem", "--key", "key.pem"];
        let ran = told(&folder, &tls, lang);
        assert!(ran.err.contains(pem), "{lang}: {}", ran.err);
    }
}
