//! Leaps through empty cells, against the definition.

use umbravox::volume::leaps::{LONGEST_LEAP, leap, octant_leaps};

use super::Random;

/// The leap of one octant.
fn unpacked(word: u32, octant: u32) -> u8 {
    leap(word >> (4 * octant) & 15)
}

/// Edge of the largest empty cube with `cell` in its near corner; what lies beyond the grid is empty.
fn largest_cube(counts: [u32; 3], occupancy: &[u8], cell: [u32; 3], octant: u32) -> u32 {
    let occupied = |inside: [u32; 3]| {
        let mut at = [0; 3];
        for a in 0..3 {
            let ascends = octant >> a & 1 == 0;
            let there = i64::from(cell[a]) + if ascends { 1 } else { -1 } * i64::from(inside[a]);
            if there < 0 || there >= i64::from(counts[a]) {
                return false;
            }
            at[a] = there as usize;
        }
        let [width, height, _] = counts.map(|n| n as usize);
        occupancy[at[0] + width * (at[1] + height * at[2])] != 0
    };
    let empty = |edge: u32| {
        (0..edge.pow(3)).all(|i| !occupied([i % edge, i / edge % edge, i / edge.pow(2)]))
    };
    (1..=u32::from(LONGEST_LEAP))
        .take_while(|&edge| empty(edge))
        .last()
        .unwrap_or(0)
}

#[test]
fn leaps_are_the_largest_empty_cubes() {
    let mut random = Random(23);
    for (counts, one_in) in [
        ([13, 9, 11], 3),
        ([13, 9, 11], 60),
        ([20, 1, 17], 40),
        ([1, 1, 30], 12),
        ([9, 8, 7], 500),
        // Rows of more than one word.
        ([70, 6, 5], 40),
        ([129, 3, 2], 60),
    ] {
        let cells = counts.iter().product::<u32>() as usize;
        let mut occupancy: Vec<u8> = (0..cells)
            .map(|_| u8::from(random.below(one_in) == 0))
            .collect();
        occupancy[cells / 2] = 1;
        let leaps = octant_leaps(counts, &occupancy);
        for (i, &word) in leaps.iter().enumerate() {
            let i = i as u32;
            let cell = [
                i % counts[0],
                i / counts[0] % counts[1],
                i / (counts[0] * counts[1]),
            ];
            for octant in 0..8 {
                let largest = largest_cube(counts, &occupancy, cell, octant);
                let expected = (0..16).map(leap).filter(|&l| u32::from(l) <= largest).max();
                assert_eq!(
                    Some(unpacked(word, octant)),
                    expected,
                    "{cell:?}, octant {octant}: {largest}"
                );
            }
            assert_eq!(word == 0, occupancy[i as usize] != 0);
            // The shaders' mark of whole blocks.
            assert_ne!(word, 1);
        }
    }
}

#[test]
fn codes_ascend_from_nothing_to_the_longest_leap() {
    let leaps: Vec<u8> = (0..16).map(leap).collect();
    assert_eq!(
        leaps,
        [0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20, 24, 28]
    );
    assert_eq!(LONGEST_LEAP, 28);
    let nothing = octant_leaps([600, 1, 1], &[0; 600]);
    assert!(nothing.iter().all(|&word| word == u32::MAX));
}
