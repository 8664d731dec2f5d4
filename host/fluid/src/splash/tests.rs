use super::*;
use crate::{
    Grid, Vessel,
    solver::{Setup, Solver},
    substance::Properties,
    surface::{Basin, SurfaceParams},
};

const DT_S: f32 = 5e-3;

const THIN: SurfaceParams =
    SurfaceParams { drag_n_s_per_m3: 100.0, tear_speed_m_s: 0.5, ..SurfaceParams::WATER };

struct World {
    surface: Surface,
    flow: Flow,
    substances: Substances,
    splash: Splash,
}

impl World {
    fn new(params: SurfaceParams) -> Self {
        let grid = Grid { cells: [24, 12, 20], spacing_m: 0.006, origin_in_world_m: Vec3::ZERO };
        let setup = Setup::new(grid, Vessel::Box);
        let basin = Basin::of_water(&grid, &Vessel::Box);
        let mut substances = Substances::new(&setup, &[Properties::of_liquid(&setup); 2]);
        substances.set_fraction(0, |p| if p.x < 0.07 { 0.8 } else { 0.0 }).expect("finite");
        Self {
            surface: Surface::new(params, &basin).expect("a box"),
            flow: Flow::new(&setup).expect("a box"),
            substances,
            splash: Splash::new(setup.density_kg_m3, 9.81),
        }
    }

    fn step(&mut self) {
        self.flow.step(f64::from(DT_S)).expect("a step");
        self.substances.step(&self.flow, f64::from(DT_S)).expect("a step");
        self.surface.step(DT_S);
        self.break_up();
    }

    fn break_up(&mut self) {
        let Self { surface, flow, substances, splash } = self;
        splash.step(Below { surface, flow, substances }, DT_S);
    }

    /// Energy of all there is, and of what went over the rim.
    fn energy_j(&self) -> f64 {
        let Self { surface, splash, flow, .. } = self;
        let drops = splash.drops().iter().map(|drop| splash.energy_j(surface, drop));
        let level_j = 0.5 * 9810.0 * 0.144 * 0.12 * f64::from(surface.level_m()).powi(2);
        let still_there_j = surface.energy_j() + flow.kinetic_energy_j() + level_j;
        still_there_j + drops.sum::<f64>() + splash.books().spilled_j
    }

    /// Volume of liquid beyond what was there, in the pot, in the air and beside it.
    fn volume_m3(&self) -> f64 {
        let splash = &self.splash;
        self.surface.volume_m3() + splash.airborne_m3() + splash.books().spilled_m3
    }
}

/// A blow that no surface can follow.
fn struck(params: SurfaceParams) -> World {
    let mut world = World::new(params);
    world.surface.kick(Vec3::new(0.06, 0.0, 0.05), 0.02, 0.05);
    world
}

#[test]
fn a_blow_throws_drops_that_fall_back_with_mass_momentum_and_colour() {
    for model in ["wave", "spring"] {
        let mut world = struck(SurfaceParams { model, ..THIN });
        let red_m3 = world.substances.volume_m3(0);
        let (mut most, mut highest_m) = (0, 0.0_f32);
        for _ in 0..400 {
            world.step();
            most = most.max(world.splash.drops().len());
            let tops = world.splash.drops().iter().map(|drop| drop.at_in_world_m.y);
            highest_m = tops.fold(highest_m, f32::max);
            let open = world.volume_m3() / world.splash.books().left_m3.max(1e-9);
            assert!(open.abs() < 1e-5, "{model}: {open} of what left");
            let red = world.substances.volume_m3(0)
                + world.splash.content_m3(0)
                + world.splash.spilled_m3(0);
            assert!((red / red_m3 - 1.0).abs() < 1e-5, "{model}: {red} {red_m3}");
        }
        let books = world.splash.books();
        assert!(most > 3 && highest_m > 0.08, "{model}: {most} drops, up to {highest_m} m");
        assert!(world.splash.drops().is_empty(), "{model}: all fell");
        assert!(books.exchanged_n_s > 0.0 && books.residual_rel() < 1e-5, "{model}: {books:?}");
        let back = (books.merged_m3 + books.spilled_m3) / books.left_m3;
        assert!((back - 1.0).abs() < 1e-9, "{model}: {back}");
    }
}

#[test]
fn energy_never_grows_by_what_breaks() {
    // A sheet of 100 g is lighter than the drops that it would throw.
    for (model, areal_mass_kg_m2) in [("wave", 20.0), ("spring", 20.0), ("spring", 0.1)] {
        let mut world = struck(SurfaceParams { model, areal_mass_kg_m2, ..THIN });
        world.surface.step(DT_S);
        let first_j = world.energy_j();
        for step in 0..200 {
            let before_j = world.energy_j();
            world.break_up();
            let excess = (world.energy_j() - before_j) / first_j;
            assert!(excess < 1e-6, "{model} {areal_mass_kg_m2} {step}: {excess}");
            world.flow.step(f64::from(DT_S)).expect("a step");
            world.surface.step(DT_S);
        }
        let books = world.splash.books();
        assert!(books.drops > 0 && books.lent_j < 1e-6 * first_j, "{model}: {books:?}");
        assert!(world.energy_j() < first_j, "{model}");
    }
}

#[test]
fn a_surface_that_rises_over_a_drop_lends_what_it_lacks() {
    let mut world = World::new(THIN);
    let at_in_world_m = Vec3::new(0.06, 0.062, 0.05);
    world.splash.drops.push(Droplet { at_in_world_m, velocity_m_s: Vec3::ZERO, volume_m3: 1e-7 });
    world.splash.content_m3.extend([0.0, 0.0]);
    world.break_up();
    let lent_j = world.splash.books().lent_j;
    // What lifts it from 1 cm below, and a little more as it raises the level.
    let exact_j = 1000.0 * 1e-7 * 9.81 * 0.01;
    assert!((lent_j / exact_j - 1.0).abs() < 1e-3, "{lent_j} {exact_j}");
}

#[test]
fn what_flies_over_the_rim_is_spilled_and_the_level_falls() {
    let mut world = World::new(THIN);
    let drop = Droplet {
        at_in_world_m: Vec3::new(0.13, 0.12, 0.05),
        velocity_m_s: Vec3::new(1.0, 0.5, 0.0),
        volume_m3: 1e-6,
    };
    world.surface.part(&drop, world.splash.weight);
    world.surface.settle();
    world.splash.drops.push(drop);
    world.splash.content_m3.extend([1e-7, 0.0]);
    (0..200).for_each(|_| world.step());
    assert!(world.splash.drops().is_empty());
    assert_eq!(world.splash.books().spilled_m3, 1e-6);
    let fallen_m = 1e-6 / (0.144 * 0.12);
    assert!((f64::from(-world.surface.level_m()) / fallen_m - 1.0).abs() < 1e-4);
    assert!(world.volume_m3().abs() < 1e-11);
}

#[test]
fn the_rim_holds_back_what_flies_below_it() {
    let mut world = World::new(THIN);
    let at_in_world_m = Vec3::new(0.14, 0.075, 0.05);
    let velocity_m_s = Vec3::new(2.0, 0.2, 0.0);
    world.splash.drops.push(Droplet { at_in_world_m, velocity_m_s, volume_m3: 1e-7 });
    world.splash.content_m3.extend([0.0, 0.0]);
    (0..100).for_each(|_| world.step());
    assert_eq!(world.splash.books().spilled_m3, 0.0);
    assert_eq!(world.splash.books().merged_m3, 1e-7);
}

#[test]
fn a_calm_surface_sheds_nothing() {
    let mut world = World::new(THIN);
    world.surface.set(|x, _| 2e-3 * (40.0 * x).cos(), |_, _| 0.0);
    (0..100).for_each(|_| world.step());
    assert_eq!(*world.splash.books(), SplashBooks::default());
}
