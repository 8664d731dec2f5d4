//! What leaves the liquid by drops, and comes back with them.

use glam::Vec3;

use super::{Substances, mixture::next_stamp};

impl Substances {
    /// Takes what is in `volume_m3` of the mixture out of the cell that holds a point; clear liquid
    /// comes in. Appends the volume of each substance that was in it to `content_m3`; nothing is
    /// taken beside the liquid, nor more than is there.
    pub fn scoop(&mut self, point_in_world_m: Vec3, volume_m3: f64, content_m3: &mut Vec<f64>) {
        let cell_m3 = f64::from(self.grid.cell_volume_m3());
        let at = self.index_at(point_in_world_m);
        let share = (volume_m3 / cell_m3).clamp(0.0, 1.0) as f32;
        for found in &mut self.all {
            let at = at.filter(|_| found.highest > 0.0);
            let taken = at.map_or(0.0, |at| found.draw_off(at, share));
            if taken > 0.0 {
                self.stamp = next_stamp();
            }
            content_m3.push(taken * cell_m3);
        }
    }

    /// Gives back volumes of the substances, in their order, to the cell that holds a point, as far
    /// as there is room; what finds none waits for it.
    pub fn give_back(&mut self, point_in_world_m: Vec3, content_m3: &[f64]) {
        let cell_m3 = f64::from(self.grid.cell_volume_m3());
        let at = self.index_at(point_in_world_m);
        let filled = |at: usize| self.all.iter().map(|s| s.cells.fraction[at]).sum::<f32>();
        let mut room = at.map_or(0.0, |at| (1.0 - filled(at)).max(0.0));
        let [i, j, k] = at.map_or([0; 3], |at| self.layout.cell_of(at));
        for (found, content_m3) in self.all.iter_mut().zip(content_m3) {
            if *content_m3 <= 0.0 {
                continue;
            }
            let given = content_m3 / cell_m3;
            found.poured_cells += given;
            found.owed_cells += given;
            self.stamp = next_stamp();
            let Some(at) = at else { continue };
            let before = found.cells.fraction[at];
            let after = before + (given as f32).min(room);
            room -= after - before;
            found.cells.fraction[at] = after;
            found.cells.include(i, j, k);
            found.highest = found.highest.max(after);
            let placed = f64::from(after) - f64::from(before);
            found.held_cells += placed;
            found.owed_cells -= placed;
        }
    }

    /// Index of the liquid cell that holds a point.
    fn index_at(&self, point_in_world_m: Vec3) -> Option<usize> {
        if !self.mask.holds(&self.grid, point_in_world_m) {
            return None;
        }
        let cell = (point_in_world_m - self.grid.origin_in_world_m) / self.grid.spacing_m;
        let [i, j, k] = cell.to_array().map(|c| c as usize);
        Some(self.layout.index(i, j, k))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Grid, Vessel,
        solver::Setup,
        substance::{Properties, Substances},
    };

    #[test]
    fn what_is_scooped_and_given_back_is_all_there() {
        let setup = Setup::new(Grid::unit_cube(8), Vessel::Box);
        let mut substances = Substances::new(&setup, &[Properties::of_liquid(&setup); 3]);
        substances.set_fraction(0, |_| 0.4).expect("finite");
        substances.set_fraction(1, |p| if p.x < 0.5 { 0.3 } else { 0.0 }).expect("finite");
        let volumes = |s: &Substances| [0, 1, 2].map(|i| s.volume_m3(i));
        let before = volumes(&substances);
        let (from, to) = (Vec3::new(0.2, 0.95, 0.3), Vec3::new(0.9, 0.95, 0.9));
        let mut content_m3 = Vec::new();
        let scooped_m3 = 0.25 * 0.125f64.powi(3);
        substances.scoop(from, scooped_m3, &mut content_m3);
        let [red, green, none] = content_m3[..] else { panic!("three substances") };
        assert!((red / (0.4 * scooped_m3) - 1.0).abs() < 1e-5 && none == 0.0);
        assert!((green / (0.3 * scooped_m3) - 1.0).abs() < 1e-5);
        assert!((volumes(&substances)[0] - (before[0] - red)).abs() < 1e-12);
        substances.give_back(to, &content_m3);
        for (now, before) in volumes(&substances).iter().zip(before) {
            assert!((now - before).abs() < 1e-12, "{now} {before}");
        }
        assert!(substances.fraction_at(1, to) > 0.0, "and it is where it fell");
        // A cell that is full has no room: what falls there waits.
        substances.give_back(to, &[1.0, 0.0, 0.0]);
        assert!(substances.fraction_at(0, to) <= 1.0);
        assert!((substances.volume_m3(0) - before[0] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn beside_the_liquid_nothing_is_taken() {
        let setup = Setup::new(Grid::unit_cube(4), Vessel::Box);
        let mut substances = Substances::new(&setup, &[Properties::of_liquid(&setup)]);
        substances.set_fraction(0, |_| 1.0).expect("finite");
        let mut content_m3 = Vec::new();
        substances.scoop(Vec3::splat(3.0), 1e-3, &mut content_m3);
        assert_eq!(content_m3, [0.0]);
    }
}
