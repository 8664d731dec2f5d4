use super::*;

/// A corner or a draw, small enough for a debug build.
fn small(seed: u64) -> Case {
    let mut case = Case::of_seed(seed);
    let is_pot = case.vessel != crate::Vessel::Box;
    let spacing_m = case.spacing_m() as f32;
    case.set_nodes(case.nodes().map(|n| n.min(20)), spacing_m, is_pot);
    case.steps = case.steps.min(60);
    case
}

#[test]
fn corners_and_draws_hold_when_small() {
    let pool = Arc::new(Pool::inline());
    let mut found = Vec::new();
    for seed in 0..24 {
        let verdict = run(&small(seed), &pool, SimdClass::detect());
        assert_eq!(verdict.replay, format!("cauldron torture surface --seed {seed}"));
        assert!(seed >= 8 || verdict.row.pass.is_some(), "{verdict:?}");
        found.extend(verdict.failures.into_iter().map(|failure| (seed, failure)));
    }
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn the_first_eight_are_corners_and_models_vessels_and_splashes_are_drawn() {
    assert!((0..8).all(|seed| corners::name(seed) == Case::of_seed(seed).corner));
    assert_eq!(corners::name(8), None);
    let cases: Vec<_> = (8..500).map(Case::of_seed).collect();
    let share = |is: fn(&Case) -> bool| {
        cases.iter().filter(|case| is(case)).count() as f64 / cases.len() as f64
    };
    assert!((0.4..0.6).contains(&share(|case| case.params.model == "wave")));
    assert!((0.2..0.4).contains(&share(|case| case.splashes)));
    assert!((0.15..0.35).contains(&share(|case| case.vessel != crate::Vessel::Box)));
    assert!((0.0..0.2).contains(&share(|case| case.nodes()[0] > 128)));
    assert!(cases.iter().all(|case| case.nodes().iter().all(|n| (2..=256).contains(n))));
}

#[test]
fn energy_and_volume_from_nowhere_are_found() {
    let case = small(9);
    let case = Case { splashes: false, ..case };
    let mut world = World::new(&case, &Arc::new(Pool::inline()), SimdClass::detect()).expect("one");
    world.surface.set(|x, z| 1e-3 * x + 1e-3 * z, |_, _| 0.0);
    let work = asked::Work::before(&world.surface);
    world.surface.set(|x, z| 2e-3 * x + 2e-3 * z, |_, _| 0.0);
    let mut ledger = Ledger::default();
    work.after(&case, &world.surface, &mut ledger, 3);
    assert!(ledger.failures["energy_excess"].contains("in step 3"), "{:?}", ledger.failures);
    // The same by a kick of as much is none.
    let mut ledger = Ledger::default();
    let mut work = asked::Work::before(&world.surface);
    work.of_kick(2.0 * world.surface.energy_j() as f32);
    world.surface.set(|x, z| 3e-3 * x + 2e-3 * z, |_, _| 0.0);
    work.after(&case, &world.surface, &mut ledger, 3);
    assert!(ledger.failures.is_empty(), "{:?}", ledger.failures);
}

#[test]
fn what_does_not_decay_is_found() {
    let mut case = small(2);
    let decay = Decay::of(&case).expect("it is dragged");
    let mut world = World::new(&case, &Arc::new(Pool::inline()), SimdClass::detect()).expect("one");
    world.surface.set(|x, _| 1e-3 * x, |_, _| 0.0);
    let mut ledger = Ledger::default();
    Decay { rate_per_s: 100.0 * decay.rate_per_s, dt_s: decay.dt_s / 100.0, ..decay }
        .ask(&mut world, &mut ledger);
    assert!(ledger.failures.contains_key("left_at_rest"), "{:?}", ledger.worst);
    let mut ledger = Ledger::default();
    decay.ask(&mut world, &mut ledger);
    assert!(ledger.failures.is_empty(), "{:?}", ledger.worst);
    case.params.drag_n_s_per_m3 = 0.0;
    assert!(Decay::of(&case).is_none());
}
