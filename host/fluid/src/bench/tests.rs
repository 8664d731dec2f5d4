use super::{
    case::{CASES, Case},
    exact::run_case,
    measure::Outcome,
    projection::run_divergence,
    target::{OURS, TARGETS, Target},
    *,
};
use crate::solver::{INDEX, SolverRow, find};

fn options() -> Options {
    Options { repetitions: 1, ..Options::quick() }
}

fn small(case: &str, n: usize) -> Vec<Row> {
    let options =
        Options { sizes: vec![n], case: Some(case.to_owned()), repetitions: 1, ..Options::quick() };
    run(&options, &mut |_| ()).expect("no input is refused")
}

fn case_of(name: &str) -> Option<&'static Case> {
    CASES.iter().find(|case| case.name == name)
}

fn value(outcome: &Outcome) -> f64 {
    outcome.values[0].1
}

#[test]
fn rows_are_complete_and_only_ours_have_targets() {
    let rows = ["mms", "divergence", "cfl-16"].map(|case| small(case, 8)).concat();
    // Three ladders of steps for ours, one for the founding solver.
    assert_eq!(rows.len(), 4 + 2 + 4);
    for row in &rows {
        assert!(row.value.is_finite(), "{row:?}");
        assert!(row.ms.is_none_or(|ms| ms > 0.0), "{row:?}");
        assert_eq!((row.target, row.pass), (None, None), "there are no targets at 8");
        assert!(row.ratio_to_founding.is_none_or(|r| (r == 1.0) == (row.method == "founding")));
    }
}

#[test]
fn every_target_is_for_a_case_that_runs() {
    for (place, target) in TARGETS.iter().enumerate() {
        assert!(NAMES.contains(&target.case), "{target:?}");
        assert!(!TARGETS[..place].contains(target), "{target:?}");
    }
}

#[test]
fn a_pair_is_missed_by_either_and_the_worst_row_speaks() {
    let row = |value, ratio, cfl| Row {
        ratio_to_founding: Some(ratio),
        params: Params::from([("cfl", Param::Number(cfl))]),
        ..measure::bare_row(&options(), "mms", OURS, 32, "rel_l2", value)
    };
    let judge = |row| target::judged(row, SimdClass::Avx512);
    assert_eq!(judge(row(1.9e-3, 1.0 / 150.0, 0.2)).pass, Some(true));
    assert_eq!(judge(row(1.9e-3, 1.0 / 140.0, 0.2)).pass, Some(false), "too slow");
    assert_eq!(judge(row(2.0e-3, 1.0 / 150.0, 0.2)).pass, Some(false), "too far off");
    assert_eq!(judge(row(f64::NAN, 0.0, 0.2)).pass, Some(false));
    assert_eq!(judge(row(1.9e-3, 1.0 / 20.0, 1.0)).pass, Some(true), "no pair in longer steps");
    let narrow = target::judged(row(1.9e-3, 1.0 / 100.0, 0.2), SimdClass::Avx2);
    assert_eq!(narrow.pass, Some(true));
    let rows = [1.0, 0.5].map(|cfl| judge(row(1.9e-3 * cfl, 0.1, cfl)));
    let verdicts = target::verdicts(TARGETS, &rows);
    assert_eq!(verdicts[1].row, Some(&rows[0]));
    assert!(verdicts[0].row.is_none());
}

#[test]
fn every_known_miss_is_within_its_brackets() {
    for solver in INDEX {
        for miss in solver.known_misses {
            let outcome = match case_of(miss.case) {
                Some(case) => run_case(case, solver, miss.n, 1.0, &options()),
                None => run_divergence(solver, miss.n, &options()),
            };
            let value = value(&outcome.expect("no input is refused"));
            assert!((miss.at_least..=miss.at_most).contains(&value), "{miss:?}: {value}");
        }
    }
}

/// What our solver reaches where the target is; never times.
fn reaches(case: &str, quantity: &str) {
    let options = Options {
        sizes: vec![32],
        methods: Some(&[OURS]),
        case: Some(case.to_owned()),
        ..options()
    };
    let rows = run(&options, &mut |_| ()).expect("no input is refused");
    let mut judged = 0;
    for row in rows.iter().filter(|row| row.quantity == quantity) {
        let Some(target) = Target::of(row) else { continue };
        assert!(row.value <= target.at_most, "{case} {quantity}: {}", row.value);
        assert!(row.number("guard_actions").is_none_or(|actions| actions == 0.0), "{row:?}");
        judged += 1;
    }
    assert!(judged > 0, "{case} {quantity}");
}

#[test]
fn ours_keeps_to_the_accuracy_of_flows_that_are_known() {
    let ours: &SolverRow = find(OURS).expect("it is in the index");
    for case in CASES {
        let outcome = run_case(case, ours, 32, 0.2, &options()).expect("no input is refused");
        let target = TARGETS.iter().find(|t| t.case == case.name && t.n == Some(32));
        let target = target.expect("every known flow has a target at 32").at_most;
        assert!(value(&outcome) <= target, "{}: {}", case.name, value(&outcome));
        assert_eq!(outcome.params["guard_actions"], Param::Number(0.0), "{}", case.name);
    }
}

#[test]
fn a_turn_keeps_the_mass_of_the_blob() {
    let turn = blob::run_blob(16, &options()).expect("no input is refused");
    let (quantity, change) = turn.values[1];
    assert_eq!(quantity, "mass_change");
    assert!(change <= 1e-5, "{change}");
}

#[test]
fn ours_keeps_to_the_accuracy_of_everything_else_that_is_short() {
    for (case, quantity) in [
        ("divergence", "after_over_before"),
        ("cfl-16", "energy_lost"),
        ("cfl-16", "energy_gained"),
        ("energy-drift", "energy_change"),
        ("bowl", "after_over_before"),
    ] {
        reaches(case, quantity);
    }
}

/// Finer grids come to 4.5e-3: that is how far the table itself is off.
#[test]
fn the_cavity_misses_its_table_by_no_more_than_the_table_misses_the_truth() {
    let options = Options {
        sizes: vec![32],
        methods: Some(&[OURS]),
        case: Some("cavity-100".to_owned()),
        ..options()
    };
    let rows = run(&options, &mut |_| ()).expect("no input is refused");
    let rms = rows.iter().find(|row| row.quantity == "rms").expect("it is measured").value;
    assert!((3.0e-3..=3.5e-3).contains(&rms), "{rms}");
}

/// What has no target is known from both sides, so that it cannot change unseen.
#[test]
fn ours_is_as_far_off_in_cut_cells_as_it_was() {
    let first = |outcome: Result<Outcome, crate::solver::SetupError>| {
        value(&outcome.expect("no input is refused"))
    };
    for (n, brackets) in [(16, 0.015..0.03), (32, 0.004..0.009)] {
        let error = first(pipe::run_pipe(n, &options()));
        assert!(brackets.contains(&error), "pipe {n}: {error}");
    }
    for (n, brackets) in [(16, 0.03..0.07), (32, 0.005..0.025)] {
        let error = first(sphere::run_sphere(n, &options()));
        assert!(brackets.contains(&error), "sphere {n}: {error}");
    }
}

#[test]
fn cases_without_a_target_are_not_quick_unless_asked_for() {
    let rows = small("sphere", 8);
    assert_eq!((rows.len(), rows[0].quantity, rows[0].target), (1, "drag_error", None));
    let named = |case| NAMES.contains(&case) && TARGETS.iter().all(|target| target.case != case);
    assert!(["pipe", "sphere"].into_iter().all(named));
}
