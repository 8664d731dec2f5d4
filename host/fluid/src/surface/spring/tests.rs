use super::*;

const WATER: SurfaceParams = SurfaceParams {
    areal_mass_kg_m2: 20.0,
    gravity_n_per_m3: 9810.0,
    tension_n_per_m: 5.0,
    bend: 0.0,
    drag_n_s_per_m3: 0.0,
    layer_decay_m: 0.05,
    contact_stiffness_n_per_m: 30.0,
    break_force_n: 0.1,
    pull_force_n: 0.1,
};

fn sheet(params: SurfaceParams) -> SpringSheet {
    let grid = Grid { cells: [16, 8, 16], spacing_m: 0.01, origin_in_world_m: Vec3::ZERO };
    SpringSheet::new(params, &grid, &Vessel::Box)
}

/// Sets the standing wave cos(pi i / 16) that the free edges allow as a sine of twice the
/// length, and the frequency that the discrete sheet gives it by its own law.
fn tilted(params: SurfaceParams) -> SpringSheet {
    let mut sheet = sheet(params);
    for n in 0..sheet.motion.height_m.len() {
        sheet.motion.height_m[n] = 1e-3 * (0.5 - (n % 17) as f32 / 16.0);
    }
    sheet.asleep = false;
    sheet
}

#[test]
fn gravity_alone_swings_every_node_at_its_frequency() {
    let mut sheet = tilted(SurfaceParams { tension_n_per_m: 0.0, ..WATER });
    let omega = (9810.0_f64 / 20.0).sqrt();
    let start = f64::from(sheet.motion.height_m[0]);
    for step in 1..=50 {
        sheet.step(4e-3);
        let exact = start * (omega * 4e-3 * f64::from(step)).cos();
        let error = f64::from(sheet.motion.height_m[0]) - exact;
        assert!(error.abs() < 2e-3 * start, "step {step}: {error}");
    }
}

#[test]
fn halving_the_step_divides_the_error_by_sixteen() {
    let params = SurfaceParams { tension_n_per_m: 0.0, ..WATER };
    let omega = (9810.0_f64 / 20.0).sqrt();
    let error = |dt_s: f32, steps: u32| {
        let mut sheet = tilted(params);
        (0..steps).for_each(|_| sheet.runge_kutta(dt_s));
        let (sin, cos) = (omega * f64::from(dt_s) * f64::from(steps)).sin_cos();
        let height = f64::from(sheet.motion.height_m[0]) - 5e-4 * cos;
        let speed = f64::from(sheet.motion.speed_m_s[0]) + 5e-4 * omega * sin;
        height.hypot(speed / omega)
    };
    let order = (error(0.02, 16) / error(0.01, 32)).log2();
    assert!((3.8..4.2).contains(&order), "{order}");
}

#[test]
fn energy_never_grows_and_drag_brings_rest() {
    let mut sheet = tilted(SurfaceParams { drag_n_s_per_m3: 60.0, bend: 0.1, ..WATER });
    let mut energy = sheet.energy_j();
    assert!(energy > 0.0);
    for _ in 0..4000 {
        sheet.step(10e-3);
        let now = sheet.energy_j();
        assert!(now <= energy * (1.0 + 1e-5), "{now} after {energy}");
        energy = now;
    }
    assert!(sheet.is_asleep());
    assert_eq!(sheet.step(10e-3), 0, "sleep costs nothing");
}

#[test]
fn volume_stays_whatever_presses() {
    let mut sheet = sheet(WATER);
    for step in 0..100 {
        sheet.touch(Vec3::new(0.05 + 1e-4 * step as f32, 0.0, 0.07), 0.012, -0.3, 0.0);
        sheet.step(10e-3);
        let volume: f64 = sheet.motion.height_m.iter().map(|y| f64::from(*y)).sum();
        assert!(volume.abs() < 1e-6, "{volume}");
    }
    assert!(sheet.at(Vec3::new(0.06, 0.0, 0.07)).0 < -1e-4, "pressed in");
}

#[test]
fn nothing_blows_up() {
    for (tension, dt_s, force) in [(1e7, 1.0, 1e4), (5.0, 1.0, 1e4), (0.0, 1e-5, 1e-9)] {
        let mut sheet = sheet(SurfaceParams { tension_n_per_m: tension, ..WATER });
        for _ in 0..20 {
            sheet.touch(Vec3::splat(0.08), 0.012, force, force);
            sheet.touch(Vec3::splat(f32::NAN), 0.012, f32::NAN, 0.0);
            sheet.touch(Vec3::splat(3e38), 3e38, 1.0, 3e38);
            sheet.step(dt_s);
        }
        assert!(sheet.motion.height_m.iter().all(|y| y.is_finite()), "{tension} {dt_s}");
    }
}

#[test]
fn beside_the_pot_nothing_moves() {
    let grid = Grid {
        cells: [16, 8, 16],
        spacing_m: 0.01,
        origin_in_world_m: Vec3::new(-0.08, -0.08, -0.08),
    };
    let pot = Vessel::Pot { centre_in_world_m: Vec3::ZERO, radius_m: 0.07 };
    let mut sheet = SpringSheet::new(WATER, &grid, &pot);
    for _ in 0..30 {
        sheet.touch(Vec3::ZERO, 0.012, -0.2, 1.0);
        sheet.step(10e-3);
    }
    assert_eq!(sheet.motion.height_m[0], 0.0);
    assert!(sheet.at(Vec3::ZERO).0 < 0.0);
}
