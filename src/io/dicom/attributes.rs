//! Attributes of a data set as plain values. What is absent, empty or of a wrong form is `None`.

use dicom_object::mem::InMemDicomObject;
use dicom_object::{DefaultDicomObject, Tag};
use glam::DVec3;

/// Looks an attribute up in several data sets, the most specific first: a frame's own functional groups, those
/// that all frames share, the object.
pub(super) struct Attributes<'a> {
    pub(super) scopes: Vec<&'a InMemDicomObject>,
    pub(super) object: &'a DefaultDicomObject,
}

impl<'a> Attributes<'a> {
    pub(super) fn of(object: &'a DefaultDicomObject) -> Self {
        Self {
            scopes: Vec::new(),
            object,
        }
    }

    /// The first item of a sequence, from the first scope that has it.
    pub(super) fn item(&self, sequence: Tag) -> Option<&'a InMemDicomObject> {
        self.datasets().find_map(|set| first_item(set, sequence))
    }

    fn datasets(&self) -> impl Iterator<Item = &'a InMemDicomObject> + '_ {
        let object: &'a InMemDicomObject = self.object;
        self.scopes.iter().copied().chain([object])
    }

    pub(super) fn text(&self, tag: Tag) -> Option<String> {
        self.datasets().find_map(|set| text(set, tag))
    }

    pub(super) fn number(&self, tag: Tag) -> Option<f64> {
        self.datasets().find_map(|set| number(set, tag))
    }

    pub(super) fn whole(&self, tag: Tag) -> Option<u64> {
        self.datasets()
            .find_map(|set| set.get(tag)?.to_int::<u64>().ok())
    }

    pub(super) fn numbers<const N: usize>(&self, tag: Tag) -> Option<[f64; N]> {
        self.datasets().find_map(|set| numbers(set, tag))
    }

    /// An attribute in the first item of a sequence (a functional group), else where it stands in single frames.
    pub(super) fn grouped<const N: usize>(&self, group: Tag, tag: Tag) -> Option<[f64; N]> {
        self.datasets()
            .find_map(|set| numbers(first_item(set, group)?, tag))
            .or_else(|| self.numbers(tag))
    }
}

pub(super) fn first_item(set: &InMemDicomObject, sequence: Tag) -> Option<&InMemDicomObject> {
    set.get(sequence)?.items()?.first()
}

pub(super) fn text(set: &InMemDicomObject, tag: Tag) -> Option<String> {
    let text = set.get(tag)?.to_str().ok()?;
    let text = text.trim_matches(|c: char| c.is_whitespace() || c == '\0');
    (!text.is_empty()).then(|| text.to_owned())
}

fn number(set: &InMemDicomObject, tag: Tag) -> Option<f64> {
    numbers::<1>(set, tag).map(|[x]| x)
}

/// Exactly or at least `N` finite numbers.
pub(super) fn numbers<const N: usize>(set: &InMemDicomObject, tag: Tag) -> Option<[f64; N]> {
    let all = set.get(tag)?.to_multi_float64().ok()?;
    let first = *all.first_chunk::<N>()?;
    first.iter().all(|x| x.is_finite()).then_some(first)
}

/// Row and column directions, made unit vectors.
pub(super) fn directions([a, b, c, d, e, f]: [f64; 6]) -> Option<[DVec3; 2]> {
    let row = DVec3::new(a, b, c).try_normalize()?;
    let column = DVec3::new(d, e, f).try_normalize()?;
    (row.cross(column).length() > 0.5).then_some([row, column])
}
