use glam::DVec2;

use super::{super::GROUPS, standing::Standing, *};
use crate::{bench::Param, simd::SimdClass, surface::SurfaceParams, vessel::Vessel};

fn small(case: &str) -> Vec<Row> {
    let given = options(true);
    let options = Options { sizes: vec![16], repetitions: 1, case: Some(case.to_owned()), ..given };
    run(&options, &mut |_| ()).expect("no input is refused")
}

/// All but times keep to their targets already where nodes are few.
#[test]
fn every_case_runs_and_is_judged() {
    for case in ["frequency", "decay", "order"] {
        let rows = small(case);
        let judged: Vec<_> = rows.iter().filter(|row| row.pass.is_some()).collect();
        for model in [WAVE, FOUNDING] {
            assert!(judged.iter().any(|row| row.method == model), "{case} {model}");
        }
        assert!(judged.iter().all(|row| row.pass == Some(true)), "{judged:?}");
    }
}

#[test]
fn waves_become_what_a_poke_becomes_and_both_models_are_timed() {
    let rows = small("poke");
    assert_eq!(rows.len(), 3 * 4);
    for row in rows.iter().filter(|row| row.case == "poke") {
        assert!(row.ms > Some(0.0), "{row:?}");
        assert!(row.method != WAVE || row.value < 0.3, "{row:?}");
        assert_eq!(row.ratio_to_founding.is_some(), row.method == WAVE);
    }
}

#[test]
fn the_law_that_is_asked_for_is_one_of_physics() {
    let params = SurfaceParams { drag_n_s_per_m3: 100.0, ..sheet::of_model(FOUNDING) };
    // 2 nu k^2 and Lamb's correction to the frequency, of thin liquids.
    let water = sheet::of_model(WAVE);
    let root = law::of_water(&water, 300.0, 1e-6);
    assert!((root.x / (-2.0 * 1e-6 * 9e4) - 1.0).abs() < 0.1, "{root}");
    let a = 1e-3 * 9e4;
    let thick = law::of_water(&water, 300.0, 1e-3);
    let left = law::times(thick + 2.0 * a * DVec2::X, thick + 2.0 * a * DVec2::X);
    let right = (left + law::of_water(&water, 300.0, 0.0).y.powi(2) * DVec2::X) / (4.0 * a * a);
    let under = DVec2::X + thick / a;
    assert!((law::times(right, right) - under).length() < 1e-9 * under.length());
    // Springs are a sheet where nodes are many, but that strips lack a shear spring.
    let [fine, sheet] = [law::of_strip(&params, 20.0, 4096), law::of_sheet(&params, 20.0)];
    assert_eq!(fine.x, sheet.x);
    assert!(fine.y < sheet.y && fine.y > 0.9 * sheet.y);
}

#[test]
fn a_law_that_is_a_little_wrong_is_missed() {
    for (model, stronger, most) in [(WAVE, 1.003, 1e-3), (FOUNDING, 1.05, 2e-2)] {
        let worst = |stronger: f64| {
            let law = |params: &SurfaceParams, k: f64| {
                let root = match model {
                    WAVE => law::of_water(params, k, 1e-6),
                    _ => law::of_strip(params, k, 16),
                };
                DVec2::new(root.x, root.y * stronger)
            };
            let params = sheet::of_model(model);
            let standing =
                Standing { params, viscosity_m2_s: 1e-6, n: 16, nodes_a_wave: 4, law: &law };
            let modes = standing.follow(1e-3, SimdClass::detect()).expect("a box");
            standing::largest(modes.iter().map(|mode| mode.frequency_error().abs()))
        };
        assert!(worst(1.0) <= most, "{model}");
        assert!(worst(stronger) > most, "{model}");
    }
}

#[test]
fn volume_stays_in_a_box_and_in_a_pot() {
    for model in [WAVE, FOUNDING] {
        let drift = volume::drift(model, &Vessel::Box, 300, SimdClass::detect());
        let drift = drift.expect("a box");
        assert!(drift > 0.0 && drift <= 1e-6, "{model}: {drift}");
    }
}

#[test]
fn every_target_is_for_a_case_that_runs_and_a_step_too_long_is_missed() {
    for group in GROUPS {
        for target in group.targets {
            assert!(group.cases.contains(&target.case), "{target:?}");
        }
    }
    let options = options(true);
    let session = Session { options: &options, rows: Vec::new(), progress: &mut |_| () };
    let row = |value| {
        let row = session.row(["step", WAVE], 256, "step_ms", value);
        target::judged(Row { params: steps_of(1e-3), ..row }, SimdClass::Avx512)
    };
    assert_eq!(row(1.01).pass, Some(false));
    assert_eq!(row(0.99).pass, Some(true));
    assert_eq!(row(f64::NAN).pass, Some(false));
    assert_eq!(row(0.5).params["dt_ms"], Param::Number(1.0));
}

#[test]
fn all_that_a_pot_asks_of_its_surface_is_timed() {
    let rows = small("beside");
    let of: Vec<_> = rows.iter().map(|row| row.params["of"].clone()).collect();
    let all = ["press", "drift", "drift-left-out", "ahead", "below", "asleep", "below-anew"];
    assert_eq!(of, all.map(Param::from));
    assert!(rows.iter().all(|row| row.value >= 0.0 && row.n == Some(64)), "{rows:?}");
}

#[test]
fn looking_for_drops_is_timed_while_nothing_breaks() {
    for model in [WAVE, FOUNDING] {
        let share = cost::splash(model, 1, SimdClass::detect()).expect("a box");
        assert!(share >= 1.0, "{model}: {share}");
    }
}
