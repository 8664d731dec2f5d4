//! The program as people call it.
#![allow(clippy::unwrap_used, reason = "a test may stop at what it did not expect")]

use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

struct Scratch(PathBuf);

impl Scratch {
    fn new(name: &str) -> Self {
        let dir = std::env::temp_dir().join(format!("cauldron-cli-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        Self(dir)
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn cauldron(dir: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cauldron")).args(args).current_dir(dir).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Bad input: exit code 2, one line, no panic.
fn refuses(dir: &Path, args: &[&str], words: &[&str]) {
    let output = cauldron(dir, args);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
    assert!(words.iter().all(|w| said.contains(w)), "{args:?}: {said}");
    assert!(!said.contains("panicked") && said.trim_end().lines().count() == 1, "{said}");
    assert!(output.stdout.is_empty());
}

#[test]
fn bad_scenes_are_refused_in_one_line_and_nothing_is_written() {
    let scratch = Scratch::new("scenes");
    let dir = &scratch.0;
    for (name, text) in [
        ("negative.toml", "[grid]\ncells = [32, -1, 32]\n"),
        ("nan.toml", "[liquid]\nviscosity_m2_s = nan\n"),
        ("unknown.toml", "[liquid]\nviscosty = 1.0\n"),
        ("broken.toml", "[liquid\n"),
    ] {
        fs::write(dir.join(name), text).unwrap();
    }
    refuses(dir, &["run", "--scene", "cauldorn"], &["cauldorn", "taylor-green"]);
    refuses(dir, &["run", "--scene", "missing.toml"], &["missing.toml", "cannot read"]);
    refuses(dir, &["run", "--scene", "negative.toml"], &["line 2", "grid.cells", "-1"]);
    refuses(dir, &["run", "--scene", "nan.toml"], &["line 2", "viscosity_m2_s", "NaN"]);
    refuses(dir, &["run", "--scene", "unknown.toml"], &["line 2", "viscosty"]);
    refuses(dir, &["run", "--scene", "broken.toml"], &["line 1"]);
    assert!(!dir.join("out").exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_refused_and_left_as_it_is() {
    let scratch = Scratch::new("out");
    let dir = &scratch.0;
    fs::write(dir.join("taken"), "mine").unwrap();
    fs::create_dir(dir.join("theirs")).unwrap();
    fs::write(dir.join("theirs/notes.txt"), "mine").unwrap();
    refuses(dir, &["run", "--out", "taken"], &["cannot write", "taken"]);
    refuses(dir, &["run", "--out", "taken/below"], &["cannot write", "taken/below"]);
    refuses(dir, &["run", "--out", "theirs"], &["notes.txt"]);
    assert_eq!(fs::read_to_string(dir.join("taken")).unwrap(), "mine");
    assert_eq!(fs::read_dir(dir.join("theirs")).unwrap().count(), 1);
}

#[test]
fn wrong_usage_is_exit_code_two() {
    let scratch = Scratch::new("usage");
    for args in [
        &["run", "--seconds", "-1"][..],
        &["run", "--seconds", "nan"],
        &["run", "--fps", "inf"],
        &["run", "--threads", "0"],
        &["run", "--simd", "mmx"],
        &["run", "--device", "usb"],
        &["bench", "fluid", "--threads", "0"],
        &["sing"],
        &["torture", "fluid", "--seeds", "7"],
        &["torture", "surface", "--seeds", "7"],
        &["torture", "fluid", "--shard", "3/2"],
        &["torture", "fluid", "--shard", "0/2"],
        &["torture", "fluid", "--seed", "9", "--shard", "1/2"],
    ] {
        assert_eq!(cauldron(&scratch.0, args).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn help_shows_examples_and_scenes_are_listed() {
    let scratch = Scratch::new("help");
    for args in [&["--help"][..], &["run", "--help"]] {
        let help = String::from_utf8(cauldron(&scratch.0, args).stdout).unwrap();
        assert!(help.contains("Examples:"), "{help}");
    }
    let list = String::from_utf8(cauldron(&scratch.0, &["scenes"]).stdout).unwrap();
    assert!(["cauldron", "empty", "taylor-green"].iter().all(|s| list.contains(s)), "{list}");
}

#[test]
fn a_seed_of_torture_is_a_row_and_shards_are_summed_up() {
    let scratch = Scratch::new("torture");
    let dir = &scratch.0;
    let output = cauldron(dir, &["torture", "fluid", "--seed", "4", "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("seed 4 (1 of 1"));
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<Value> = text.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!((lines.len(), &lines[0]["case"]), (2, &Value::from("2^3")));
    assert_eq!((&lines[0]["value"], &lines[0]["pass"]), (&Value::from(0.0), &Value::from(true)));
    assert_eq!(lines[0]["replay"], "cauldron torture fluid --seed 4");
    assert!(lines[0]["params"]["energy_excess"].is_f64());
    let mut part = lines[1].clone();
    for (name, ran, failed) in [
        ("even", vec![0, 2, 4, 6, 8], vec![]),
        ("odd", vec![1, 3, 5, 7], vec![]),
        ("bad", vec![1, 3, 5, 7], vec![5]),
    ] {
        part["summary"]["seeds"] = 9.into();
        part["summary"]["ran"] = ran.into();
        part["summary"]["failed"] = failed.into();
        fs::write(dir.join(name), part.to_string() + "\n").unwrap();
    }
    fs::write(dir.join("torn"), "{\"group\": \"tor").unwrap();
    let merge = |files: &[&str]| cauldron(dir, &[&["torture", "fluid", "--merge"], files].concat());
    assert_eq!(merge(&["even", "odd"]).status.code(), Some(0));
    assert_eq!(merge(&["even", "bad"]).status.code(), Some(1));
    let alone = merge(&["odd"]);
    assert_eq!(alone.status.code(), Some(1));
    assert!(stderr(&alone).contains("corners left out: 96^3"), "{}", stderr(&alone));
    refuses(dir, &["torture", "fluid", "--merge", "even", "torn"], &["torn", "last line"]);
    refuses(dir, &["torture", "fluid", "--merge", "none"], &["none", "cannot read"]);
    refuses(dir, &["torture", "surface", "--merge", "even"], &["torture fluid"]);
}

#[test]
fn surfaces_are_tortured_by_the_same_rules() {
    let scratch = Scratch::new("torture-surface");
    let output = cauldron(&scratch.0, &["torture", "surface", "--seed", "1", "--json"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<Value> = text.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    assert_eq!((&lines[0]["case"], &lines[0]["method"]), (&"2x2".into(), &"spring".into()));
    assert_eq!(lines[0]["replay"], "cauldron torture surface --seed 1");
    assert_eq!(lines[1]["summary"]["group"], "surface");
}

#[test]
fn an_unknown_case_of_the_benchmark_is_refused_with_those_there_are() {
    let scratch = Scratch::new("case");
    refuses(&scratch.0, &["bench", "fluid", "--case", "mns"], &["mns", "mms", "cavity-1000"]);
    refuses(&scratch.0, &["bench", "surface", "--case", "mms"], &["mms", "frequency", "splash"]);
}

#[test]
fn surfaces_are_measured_drawn_and_judged_in_rows_of_the_same_kind() {
    let scratch = Scratch::new("bench-surface");
    let output = cauldron(&scratch.0, &["bench", "surface", "--quick", "--case", "order"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(text.contains("\u{2713}    order spring: order_less_4 <="), "{text}");
    let args = ["bench", "surface", "--quick", "--case", "poke", "--json", "--plot", "d"];
    let json = cauldron(&scratch.0, &args);
    for line in String::from_utf8(json.stdout).unwrap().lines() {
        let row: Value = serde_json::from_str(line).unwrap();
        assert_eq!(row["group"], "surface");
        assert!(row["params"]["dt_ms"].is_number(), "{row}");
    }
    let svg = fs::read_to_string(scratch.0.join("d/surface-poke.svg")).unwrap();
    assert!(svg.contains("wave, dt/ms 1") && svg.contains("spring, dt/ms 1"), "{svg}");
}

#[test]
fn a_case_is_measured_drawn_and_judged() {
    let scratch = Scratch::new("bench");
    let args = ["bench", "fluid", "--quick", "--case", "cavity-100", "--plot", "d"];
    let output = cauldron(&scratch.0, &args);
    let text = String::from_utf8(output.stdout).unwrap();
    let line = text.lines().find(|line| line.contains("cavity-100 auto n=32: rms <=")).unwrap();
    let is_kept = line.starts_with('\u{2713}');
    assert_eq!(output.status.code(), Some(i32::from(!is_kept)), "{text}");
    assert!(cauldron_render::png::read(scratch.0.join("d/fluid-cavity-100.png")).is_ok());
    let svg = fs::read_to_string(scratch.0.join("d/fluid-cavity-100.svg")).unwrap();
    assert!(svg.contains("auto"), "{svg}");
    let json = cauldron(&scratch.0, &[&args[..5], &["--json"]].concat());
    for line in String::from_utf8(json.stdout).unwrap().lines() {
        let row: Value = serde_json::from_str(line).unwrap();
        assert_eq!((&row["group"], &row["case"]), (&"fluid".into(), &"cavity-100".into()));
        assert!(row["params"]["steps"].is_number() && row["ratio_to_founding"].is_number());
    }
}

/// What the whole program promises of its default scene.
#[test]
fn ten_seconds_of_the_cauldron_keep_their_promises() {
    let scratch = Scratch::new("promises");
    let output = cauldron(&scratch.0, &["run", "--json", "--fps", "0", "--out", "o"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = String::from_utf8(output.stdout).unwrap();
    let json: Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    let number = |key: &str| json[key].as_f64().unwrap_or_else(|| panic!("no {key} in {text}"));
    assert_eq!((number("ticks"), number("ticks_missed")), (10_000.0, 0.0));
    assert_eq!((number("seconds"), number("steps")), (10.0, 1000.0));
    assert!(json["grid"].as_array().unwrap().iter().all(|n| n.as_u64() >= Some(32)));
    assert!(number("force_n_max") <= number("force_n_limit"));
    assert!(number("momentum_residual_rel") <= 1e-5);
    assert!(number("impulse_n_s") >= 0.01);
    assert!(number("force_n_rms_wet") >= 0.05);
    assert!((650.0..=1000.0).contains(&number("fields")), "65 to 100 a second");
    assert!(number("fields_sent") <= number("fields"));
    assert!(number("field_bytes") / number("seconds") <= 0.8e6);
    assert!(number("divergence_max") < 1e-2 && number("fluid_ke_max") > 1e-4);
    assert!(number("cpu_s") > 0.0 && number("wall_s") > 0.0);
    assert_eq!(number("guard_actions"), 0.0);
    assert_eq!(json["surface"], "wave");
    figures_follow_from_the_trace(&scratch.0.join("o/run.csv"), &number);
    let saved = fs::read_to_string(scratch.0.join("o/run.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&saved).unwrap(), json);
}

fn figures_follow_from_the_trace(path: &Path, number: &dyn Fn(&str) -> f64) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = "tick,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,fx_n,fy_n,fz_n,wet";
    assert_eq!(lines.next(), Some(header));
    let rows: Vec<Vec<f64>> =
        lines.map(|l| l.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), 10_000);
    assert!(rows.iter().zip(0..).all(|(row, tick)| row[0] == f64::from(tick)));
    let squared = |row: &Vec<f64>| row[7..10].iter().map(|f| f * f).sum::<f64>();
    let largest = rows.iter().map(|r| squared(r).sqrt()).fold(0.0, f64::max);
    let wet: Vec<_> = rows.iter().filter(|r| r[10] == 1.0).collect();
    let rms = (wet.iter().map(|r| squared(r)).sum::<f64>() / wet.len() as f64).sqrt();
    let work =
        |w: &[Vec<f64>]| (0..3).map(|i| w[0][7 + i] * (w[1][1 + i] - w[0][1 + i])).sum::<f64>();
    let given: f64 = rows.windows(2).map(work).sum();
    for (key, value) in
        [("force_n_max", largest), ("force_n_rms_wet", rms), ("energy_to_hand_j", given)]
    {
        // The trace has the digits of an f32.
        assert!((number(key) - value).abs() < 1e-6, "{key}: {} and {value}", number(key));
    }
}

#[test]
fn frames_sheet_and_plot_are_pictures() {
    let scratch = Scratch::new("pictures");
    let args = ["run", "--seconds", "0.5", "--fps", "4", "--out", "o"];
    let output = cauldron(&scratch.0, &args);
    assert!(output.status.success(), "{}", stderr(&output));
    for name in ["frame-0001.png", "frame-0002.png", "contact-sheet.png", "plot.png"] {
        let picture = cauldron_render::png::read(scratch.0.join("o").join(name)).unwrap();
        assert!(picture.width() >= 400 && picture.height() >= 100, "{name}");
        let bytes = fs::read(scratch.0.join("o").join(name)).unwrap();
        // IHDR: 8 bits, RGB or RGBA, not interlaced.
        assert_eq!(bytes[24], 8);
        assert!(bytes[25] == 2 || bytes[25] == 6);
        assert_eq!(bytes[28], 0);
    }
    assert!(!scratch.0.join("o/frame-0003.png").exists());
    assert!(stderr(&output).contains("steps/s"), "a progress line");
}
