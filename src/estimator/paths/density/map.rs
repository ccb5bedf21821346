//! Photons where they were stored, found again by place.

use super::Kernel;
use super::disk::Flat;
use crate::geometry::Vec2;
use crate::scene::Side;
use std::f64::consts::PI;

/// Photons a cell, on average.
const PHOTONS_A_CELL: f64 = 2.0;

/// Where a photon was stored.
#[derive(Clone, Copy)]
pub(super) struct Hit {
    pub facet: usize,
    pub side: Side,
    /// In the facet's plane.
    pub at: Vec2,
    /// The first of the columns that its power counts in.
    pub column: usize,
}

/// Photons as they come.
pub(super) struct PhotonMap {
    n_bands: usize,
    hits: Vec<Hit>,
    /// Reflected power, W, one value a band, hit by hit.
    powers: Vec<f64>,
}

/// Photons by side of a facet, and there by cell.
pub(super) struct SortedMap {
    n_bands: usize,
    hits: Vec<Hit>,
    powers: Vec<f64>,
    sheets: Vec<Sheet>,
}

/// The photons on one side of a facet: a grid over the rectangle around it.
struct Sheet {
    low: Vec2,
    /// Edge of a cell, metres.
    cell: f64,
    n_cells: [usize; 2],
    /// Photons of cell c are order[first[c]] .. order[first[c + 1]].
    first: Vec<u32>,
    order: Vec<u32>,
}

/// The photons that light a point.
pub(super) struct Around<'m> {
    /// First column and powers.
    pub photons: Vec<(usize, &'m [f64])>,
    /// Of the facet that they are spread over, m².
    pub area: f64,
}

impl PhotonMap {
    pub fn new(n_bands: usize) -> Self {
        Self { n_bands, hits: Vec::new(), powers: Vec::new() }
    }

    pub fn store(&mut self, hit: Hit, power: &[f64]) {
        self.hits.push(hit);
        self.powers.extend_from_slice(power);
    }

    /// Makes it ready to be asked. Cost O(photons + facets).
    pub fn sorted(self, flats: &[Flat]) -> SortedMap {
        let mut on = vec![Vec::new(); 2 * flats.len()];
        for (k, hit) in (0..).zip(&self.hits) {
            on[sheet_of(hit.facet, hit.side)].push(k);
        }
        let sheets = on.into_iter().enumerate().map(|(k, photons)| Sheet::new(&flats[k / 2], photons, &self.hits));
        SortedMap { sheets: sheets.collect(), n_bands: self.n_bands, hits: self.hits, powers: self.powers }
    }
}

impl SortedMap {
    /// The photons that light a point of a facet's side. Those of [`Kernel::Nearest`] are all on that side if there are fewer than k.
    pub fn around(&self, (facet, side): (usize, Side), flat: &Flat, at: Vec2, kernel: Kernel) -> Around<'_> {
        let sheet = &self.sheets[sheet_of(facet, side)];
        match kernel {
            Kernel::Radius(radius) => {
                let photons = self.within(sheet, at, radius).map(|(_, photon)| self.photon(photon)).collect();
                Around { photons, area: flat.area_within(at, radius) }
            }
            Kernel::Nearest(k) if sheet.order.len() < k => {
                Around { photons: sheet.order.iter().map(|photon| self.photon(*photon)).collect(), area: flat.area }
            }
            Kernel::Nearest(k) => {
                let mut near = self.nearest(sheet, flat, at, k);
                let (closer, kth, _) = near.select_nth_unstable_by(k - 1, |a, b| a.0.total_cmp(&b.0));
                let area = flat.area_within(at, kth.0.sqrt());
                closer.sort_unstable_by_key(|(_, photon)| *photon);
                Around { photons: closer.iter().map(|(_, photon)| self.photon(*photon)).collect(), area }
            }
        }
    }

    /// At least k photons, the k nearest among them: squared distances and numbers.
    fn nearest(&self, sheet: &Sheet, flat: &Flat, at: Vec2, k: usize) -> Vec<(f64, u32)> {
        let mut radius = (2.0 * k as f64 * flat.area / (PI * sheet.order.len() as f64)).sqrt();
        loop {
            let near: Vec<(f64, u32)> = self.within(sheet, at, radius).collect();
            if near.len() >= k {
                return near;
            }
            radius *= 2.0;
        }
    }

    /// Photons within a distance: squared distances and numbers.
    fn within(&self, sheet: &Sheet, at: Vec2, radius: f64) -> impl Iterator<Item = (f64, u32)> {
        let [columns, rows] = sheet.cells_around(at, radius);
        let cells = rows.flat_map(move |row| columns.clone().map(move |column| row * sheet.n_cells[0] + column));
        let photons = cells.flat_map(|cell| &sheet.order[sheet.first[cell] as usize..sheet.first[cell + 1] as usize]);
        let distances = photons.map(move |photon| (self.hits[*photon as usize].at.distance_squared(at), *photon));
        distances.filter(move |(distance_squared, _)| *distance_squared < radius * radius)
    }

    fn photon(&self, photon: u32) -> (usize, &[f64]) {
        let photon = photon as usize;
        (self.hits[photon].column, &self.powers[photon * self.n_bands..][..self.n_bands])
    }
}

impl Sheet {
    fn new(flat: &Flat, photons: Vec<u32>, hits: &[Hit]) -> Self {
        let extent = flat.high - flat.low;
        let cell = (PHOTONS_A_CELL * extent.x * extent.y / photons.len().max(1) as f64)
            .sqrt()
            .max(extent.max_element() * 1e-3);
        let n_cells = [extent.x, extent.y].map(|extent| (extent / cell) as usize + 1);
        let mut sheet =
            Self { low: flat.low, cell, n_cells, first: vec![0; n_cells[0] * n_cells[1] + 1], order: Vec::new() };

        // Count, add up, place.
        let cells: Vec<usize> = photons.iter().map(|photon| sheet.cell_of(hits[*photon as usize].at)).collect();
        cells.iter().for_each(|cell| sheet.first[cell + 1] += 1);
        (1..sheet.first.len()).for_each(|k| sheet.first[k] += sheet.first[k - 1]);
        let mut next = sheet.first.clone();
        sheet.order = vec![0; photons.len()];
        for (photon, cell) in photons.into_iter().zip(cells) {
            sheet.order[next[cell] as usize] = photon;
            next[cell] += 1;
        }
        sheet
    }

    /// Column and row of the cell at a point, or of the one nearest to it.
    fn place(&self, at: Vec2) -> [usize; 2] {
        let offset = (at - self.low) / self.cell;
        [(offset.x.max(0.0) as usize).min(self.n_cells[0] - 1), (offset.y.max(0.0) as usize).min(self.n_cells[1] - 1)]
    }

    fn cell_of(&self, at: Vec2) -> usize {
        let [column, row] = self.place(at);
        row * self.n_cells[0] + column
    }

    /// Columns and rows that a disk may reach into.
    fn cells_around(&self, at: Vec2, radius: f64) -> [std::ops::RangeInclusive<usize>; 2] {
        let ([left, low], [right, high]) = (self.place(at - radius), self.place(at + radius));
        [left..=right, low..=high]
    }
}

/// The number of a facet's side.
fn sheet_of(facet: usize, side: Side) -> usize {
    2 * facet + usize::from(side == Side::Back)
}
