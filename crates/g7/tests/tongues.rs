//! Io files, refusals of printers, files and last lines in French and Portuguese.
#![allow(missing_docs, reason = "a test")]

mod common;

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
