//! Level-of-detail selection.

use umbravox::volume::blocks::{BlockGrid, FINEST, brick_texels};
use umbravox::volume::layout::AtlasLayout;
use umbravox::volume::select::{Classify, Request, Selection, select};
use umbravox::volume::statistics::BlockStatistics;
use umbravox::volume::{Volume, Voxels};

use super::{Field, Random, positions, random_u8, volume_of};

/// White above a threshold, with opacity rising from it.
struct Above(f64);

impl Classify for Above {
    fn premultiplied(&self, value: f64) -> [f32; 7] {
        let a = ((value - self.0) / 100.0).clamp(0.0, 1.0) as f32;
        [a, a, a, a, 0.0, 0.0, 0.0]
    }

    fn visible(&self, range: [f64; 2]) -> bool {
        range[1] > self.0
    }
}

/// A rough ball in noise-free darkness, with a partial last block on each axis.
fn ball() -> Volume {
    let mut random = Random(50);
    volume_of([84, 75, 66], Voxels::U8, |at| {
        let [x, y, z] = [0, 1, 2].map(|a| f64::from(at[a]) - [40.0, 36.0, 32.0][a]);
        let inside = 28.0 - (x * x + y * y + z * z).sqrt();
        let rough = 30.0 * random.unit() * (1.0 + x / 40.0);
        (inside * 8.0 + rough).clamp(0.0, 255.0) as u8
    })
}

fn request(data_reduction: f64, max_bytes: u64) -> Request {
    Request {
        data_reduction,
        max_bytes,
        bytes_per_texel: 5,
    }
}

fn own_voxels(grid: &BlockGrid, selection: &Selection) -> u64 {
    let levels = selection.levels.by_block.iter().enumerate();
    levels
        .filter_map(|(block, level)| Some(grid.own_voxels(block, (*level)?)))
        .sum()
}

#[test]
fn everything_is_finest_when_it_fits() {
    let volume = ball();
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    let selection = select(&statistics, &Above(60.0), &request(1.0, 1 << 30)).unwrap();
    let blocks = statistics.grid().len();
    assert_eq!(selection.levels.by_block, vec![Some(FINEST); blocks]);
    assert_eq!(selection.by_level, [0, 0, 0, 0, blocks]);
    assert_eq!((selection.error, selection.dropped), (0.0, 0));
    assert_eq!(selection.data_reduction, 1.0);
}

#[test]
fn error_falls_as_the_budget_grows() {
    let volume = ball();
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    let grid = statistics.grid();
    let cells = own_voxels(
        grid,
        &select(&statistics, &Above(60.0), &request(1.0, 1 << 30)).unwrap(),
    );
    let voxels: u64 = volume.size().iter().map(|&n| u64::from(n)).product();

    let mut last = f64::INFINITY;
    let mut errors = Vec::new();
    for step in 0..200 {
        let reduction = 30_000.0 * 0.95_f64.powi(step).max(1.0 / 30_000.0);
        let selection = select(&statistics, &Above(60.0), &request(reduction, 1 << 30)).unwrap();
        let own = own_voxels(grid, &selection);
        assert!(
            own as f64 <= voxels as f64 / reduction,
            "r = {reduction}: {own} voxels"
        );
        if own > 0 {
            assert_eq!(selection.data_reduction, cells as f64 / own as f64);
        }
        assert!(
            selection.error <= last,
            "error rises from {last} to {} at r = {reduction}",
            selection.error
        );
        last = selection.error;
        errors.push(selection.error);
    }
    assert_eq!(last, 0.0);
    errors.dedup();
    assert!(errors.len() > 50, "only {} different errors", errors.len());

    let mut last = f64::INFINITY;
    for kib in (0..4000).step_by(25) {
        let selection = select(&statistics, &Above(60.0), &request(1.0, kib << 10)).unwrap();
        assert!(selection.error <= last, "error rises at {kib} KiB");
        last = selection.error;
        let whole = selection.by_level[usize::from(FINEST)] == grid.len();
        let texels: u64 = selection
            .levels
            .by_block
            .iter()
            .flatten()
            .map(|&l| brick_texels(l) as u64)
            .sum();
        assert!(
            whole || 5 * texels <= kib << 10,
            "{texels} texels at {kib} KiB"
        );
        if selection.levels.resident() >= 50 {
            let layout = AtlasLayout::plan(grid, &selection.levels, 2048).unwrap();
            assert!(5 * layout.texels() <= kib << 10, "atlas exceeds {kib} KiB");
        }
    }
    assert_eq!(last, 0.0);
}

#[test]
fn hidden_blocks_are_absent_and_leave_no_ghost() {
    let volume = ball();
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    let grid = *statistics.grid();
    let shown = Above(60.0);
    let selection = select(&statistics, &shown, &request(5.0, 1 << 30)).unwrap();
    let mut hidden = 0;
    for block in 0..grid.len() {
        let visible = shown.visible(statistics.block_value_range(block));
        assert_eq!(selection.levels.by_block[block].is_some(), visible);
        hidden += usize::from(!visible);
    }
    assert!(hidden > 0 && hidden < grid.len());
    assert_eq!(selection.dropped, 0);
    assert!(
        selection.by_level[..2].iter().all(|&n| n == 0),
        "below level 2"
    );
    assert!(
        selection.by_level[3] + selection.by_level[4] > 0,
        "nothing above level 2"
    );

    let field = Field::new(&volume, &selection.levels);
    let mut shared = 0;
    for (block, _) in field.resident() {
        for at in positions(&grid, block, 17) {
            let in_hidden = (0..grid.len()).any(|other| {
                let (first, m) = (grid.origin_ix(other), grid.cells(other));
                selection.levels.by_block[other].is_none()
                    && (0..3).all(|a| {
                        (f64::from(first[a])..=f64::from(first[a] + m[a])).contains(&at[a])
                    })
            });
            if in_hidden {
                shared += 1;
                let value = field.sample(block, at);
                assert!(
                    value <= 60.0,
                    "{value} shows at {at:?}, beside a hidden block"
                );
            }
        }
    }
    assert!(shared > 0);
}

#[test]
fn tight_budgets_lower_the_floor_and_say_what_is_lost() {
    let volume = random_u8([65, 65, 65], &mut Random(51));
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    // 64 visible blocks of 4096 cells.
    for (reduction, lowest, dropped) in [
        (60.0, Some(2), false),
        (100.0, Some(1), false),
        (1000.0, Some(0), false),
        (10_000.0, None, true),
    ] {
        let selection = select(&statistics, &Above(60.0), &request(reduction, 1 << 30)).unwrap();
        let levels = &selection.levels.by_block;
        assert_eq!(levels.iter().min(), Some(&lowest), "r = {reduction}");
        assert_eq!(selection.dropped > 0, dropped, "r = {reduction}");
        assert_eq!(selection.dropped, 64 - selection.levels.resident());
        assert!(selection.error > 0.0);
    }
    let nothing = select(&statistics, &Above(60.0), &request(2.0, 0)).unwrap();
    assert_eq!((nothing.levels.resident(), nothing.dropped), (0, 64));
}

#[test]
fn steps_without_gain_are_not_taken() {
    // Constant blocks and linear ramps gain nothing from finer levels.
    let volume = volume_of([65, 33, 33], Voxels::F32, |at| at[0].max(16) as f32 + 100.0);
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    let selection = select(&statistics, &Above(60.0), &request(1.5, 1 << 30)).unwrap();
    let blocks = statistics.grid().len();
    assert_eq!(selection.by_level, [0, 0, blocks, 0, 0]);
    assert_eq!(selection.error, 0.0);
}

#[test]
fn the_same_request_gives_the_same_levels() {
    let volume = ball();
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    let again = BlockStatistics::of(volume.clone().into()).unwrap();
    for reduction in [1.5, 4.0, 12.0] {
        assert_eq!(
            select(&statistics, &Above(60.0), &request(reduction, 1 << 20)).unwrap(),
            select(&again, &Above(60.0), &request(reduction, 1 << 20)).unwrap()
        );
    }
}

#[test]
fn detail_goes_where_the_transfer_function_shows_it() {
    // Equal noise in both halves; only the upper half lies where opacity changes.
    let mut random = Random(52);
    let volume = volume_of([65, 33, 33], Voxels::U8, |at| {
        let base = if at[0] <= 32 { 170 } else { 70 };
        base + random.below(60) as u8
    });
    let statistics = BlockStatistics::of(volume.clone().into()).unwrap();
    let selection = select(&statistics, &Above(60.0), &request(2.2, 1 << 30)).unwrap();
    for (block, level) in selection.levels.by_block.iter().enumerate() {
        let varied = statistics.grid().position(block)[0] > 2;
        let opaque = statistics.grid().position(block)[0] < 2;
        assert!(!opaque || *level == Some(2), "opaque block at {level:?}");
        assert!(!varied || *level >= Some(3), "varied block at {level:?}");
    }
}

#[test]
fn a_reduction_below_one_is_refused() {
    let statistics = BlockStatistics::of(ball().into()).unwrap();
    for reduction in [0.5, 0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(select(&statistics, &Above(60.0), &request(reduction, 1)).is_err());
    }
}
