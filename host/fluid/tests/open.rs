//! Sides that let out what comes: what passes them, and the energy that is left.

use cauldron_fluid::{
    Grid, Vessel,
    solver::{Setup, Side, Sides, Solver, flow::Flow},
};
use glam::{DVec3, Vec3};
use oorandom::Rand64;

/// Three waves of up to 1 m/s, at random.
fn waves(draws: &mut Rand64) -> impl Fn(DVec3) -> DVec3 + use<> {
    let mut any = || 2.0 * draws.rand_float() - 1.0;
    let mut vector = || DVec3::new(any(), any(), any());
    let waves = [(); 3].map(|()| (vector(), 8.0 * vector(), 3.0 * vector().x));
    move |p| waves.iter().map(|(u, k, at)| *u * (k.dot(p) + at).sin()).sum::<DVec3>() / 2.0
}

/// Random waves in a box of which at least one side is open.
fn any_open_box(seed: u64, viscosity_m2_s: f32) -> Flow {
    let mut draws = Rand64::new(u128::from(seed));
    let cells = [(); 3].map(|()| 6 + draws.rand_range(0..8) as usize);
    let mut side = || if draws.rand_float() < 0.5 { Side::Outflow } else { Side::FreeSlip };
    let mut sides = Sides([(); 3].map(|()| [side(), side()]));
    sides.0[seed as usize % 3][seed as usize / 3 % 2] = Side::Outflow;
    let grid = Grid { cells, ..Grid::unit_cube(10) };
    let setup = Setup { sides, viscosity_m2_s, ..Setup::new(grid, Vessel::Box) };
    let mut flow = Flow::new(&setup).expect("a flow");
    flow.set_velocity(&waves(&mut draws)).expect("finite");
    flow.project();
    flow
}

#[test]
fn energy_only_leaves_an_open_box_and_the_guard_has_nothing_to_do() {
    for seed in 0..20 {
        let mut flow = any_open_box(seed, 0.0);
        let cfl = [0.1, 0.3, 0.7, 1.0][seed as usize % 4];
        let first_j = flow.kinetic_energy_j();
        let (mut energy_j, mut acts) = (first_j, 0);
        for _ in 0..300 {
            let before_j = energy_j;
            acts += flow.step(cfl * 0.1 / 1.5).expect("finite").guard_actions;
            energy_j = flow.kinetic_energy_j();
            assert!(energy_j <= before_j, "seed {seed}: {before_j} {energy_j}");
        }
        assert_eq!(acts, 0, "seed {seed}");
        assert!(energy_j < 0.9 * first_j && energy_j > 0.01 * first_j, "{energy_j} of {first_j}");
    }
}

#[test]
fn thick_liquid_in_an_open_box_comes_to_rest_or_streams_through() {
    for (seed, viscosity_m2_s) in (0..6).flat_map(|seed| [0.1, 10.0].map(|nu| (seed, nu))) {
        let mut flow = any_open_box(seed, viscosity_m2_s);
        let first_j = flow.kinetic_energy_j();
        let mut acts = 0;
        for _ in 0..10 {
            acts += flow.step(0.1).expect("finite").guard_actions;
        }
        let left = flow.kinetic_energy_j() / first_j;
        assert!(acts == 0 && left < 0.2, "seed {seed}, {viscosity_m2_s} m^2/s: {acts}, {left}");
    }
}

/// What is drawn from rest into an open tube meets p = -u^2 / 2 there, and what leaves takes its
/// energy along: L du/dt = -u^2 / 2, half a cell beyond both ends being part of the tube.
#[test]
fn a_stream_through_an_open_tube_loses_what_it_takes_along() {
    for axis in 0..3 {
        let sides = Sides::all(Side::FreeSlip).with(axis, [Side::Outflow; 2]);
        let mut cells = [2; 3];
        cells[axis] = 20;
        let setup =
            Setup { sides, ..Setup::new(Grid { cells, ..Grid::unit_cube(20) }, Vessel::Box) };
        for sign in [1.0, -1.0] {
            let mut flow = Flow::new(&setup).expect("a flow");
            flow.set_velocity(&|_| sign * DVec3::AXES[axis]).expect("finite");
            for _ in 0..100 {
                assert_eq!(flow.step(0.02).expect("finite").guard_actions, 0);
            }
            let exact_m_s = sign / (1.0 + 2.0 / (2.0 * 21.0 / 20.0));
            flow.visit(&mut |_, c, u| {
                let expected = if c == axis { exact_m_s } else { 0.0 };
                assert!((u - expected).abs() < 1e-4, "{axis} {sign}: {u} {expected}");
            });
        }
    }
}

/// A vortex in a stream of 1 m/s, up to `swirl_m_s` faster or slower, in a channel of that length
/// in metres, `n` cells to each.
fn vortex_in_a_stream(n: usize, length: usize, swirl_m_s: f64) -> Flow {
    let through = [Side::Inflow(Vec3::X), Side::Outflow];
    let sides = Sides::all(Side::FreeSlip).with(0, through);
    let grid = Grid { cells: [length * n, n, 1], ..Grid::unit_cube(n) };
    let mut flow = Flow::new(&Setup { sides, ..Setup::new(grid, Vessel::Box) }).expect("a flow");
    let radius_m = 0.12;
    let swirl = move |p: DVec3| {
        let from = (p - DVec3::new(1.0, 0.5, 0.0)) / radius_m;
        let fall = (0.5 - 0.5 * (from.x * from.x + from.y * from.y)).exp();
        DVec3::X + swirl_m_s * fall * DVec3::new(-from.y, from.x, 0.0)
    };
    flow.set_velocity(&swirl).expect("finite");
    flow.project();
    flow
}

/// Energy of the difference to the stream, or to another flow, over the first 1.5 m.
fn difference(flow: &Flow, other: Option<&Flow>) -> f64 {
    let mut squares = 0.0;
    flow.visit(&mut |p, c, u| {
        let at = p.as_vec3();
        let expected = other.map_or(DVec3::X, |other| other.velocity_at(at).as_dvec3())[c];
        squares += if p.x < 1.5 { (u - expected).powi(2) } else { 0.0 };
    });
    squares
}

#[test]
fn a_vortex_leaves_through_an_open_side_and_little_comes_back() {
    for swirl_m_s in [0.3, 1.5] {
        // What comes back of it is of the second order in the spacing.
        let back = [16, 32].map(|n| {
            let [mut flow, mut long] = [2, 4].map(|len| vortex_in_a_stream(n, len, swirl_m_s));
            let first = difference(&flow, None);
            let (mut apart, steps, dt_s) = (0f64, 12 * n, 1.0 / (3 * n) as f64);
            for step in 0..steps {
                flow.step(dt_s).expect("finite");
                if step < steps / 2 {
                    long.step(dt_s).expect("finite");
                    apart = apart.max(difference(&flow, Some(&long)) / first);
                }
            }
            [difference(&flow, None) / first, apart]
        });
        let [[left, apart], [left_fine, apart_fine]] = back;
        assert!(left < 0.08 && apart < 0.05, "{swirl_m_s}: {back:?}");
        assert!(left_fine < 0.25 * left && apart_fine < 0.7 * apart, "{swirl_m_s}: {back:?}");
    }
}
