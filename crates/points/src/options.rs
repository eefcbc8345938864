//! What of a point file is read.

use crate::assign::Columns;
use crate::filter::Filter;
use crate::names;
use crate::stream::Outlet;

/// What of a point file is kept. The default is everything.
///
/// What is left out is never held: a file of which every tenth point is kept takes a tenth of the
/// memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Which numbers of each point are kept beside its position.
    pub wanted: Wanted,
    /// Which points are kept.
    pub filter: Filter,
    /// Which column of the file is what.
    pub columns: Columns,
    /// Where points go instead of being held: what is read then has none. For what goes through a
    /// file point by point, as [`summarize`](crate::summarize) does.
    pub outlet: Option<Outlet>,
}

/// Which numbers of each point are kept beside its position.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Wanted {
    /// All.
    #[default]
    All,
    /// These.
    Some {
        /// Whether colours are.
        colors: bool,
        /// Whether normals are.
        normals: bool,
        /// The attributes that these names mean, where the file has them.
        attributes: Vec<String>,
    },
}

impl Wanted {
    /// What either wants.
    #[must_use]
    pub fn or(&self, other: &Self) -> Self {
        let (Self::Some { attributes: own, .. }, Self::Some { attributes: others, .. }) =
            (self, other)
        else {
            return Self::All;
        };
        let mut attributes = own.clone();
        attributes.extend(others.iter().filter(|name| !own.contains(name)).cloned());
        Self::Some {
            colors: self.colors() || other.colors(),
            normals: self.normals() || other.normals(),
            attributes,
        }
    }

    pub(crate) fn colors(&self) -> bool {
        matches!(self, Self::All | Self::Some { colors: true, .. })
    }

    pub(crate) fn normals(&self) -> bool {
        matches!(self, Self::All | Self::Some { normals: true, .. })
    }

    /// Which of the attributes of these names are.
    pub(crate) fn attributes_among<'a>(
        &self,
        names: impl ExactSizeIterator<Item = &'a str> + Clone,
    ) -> Vec<bool> {
        let Self::Some { attributes, .. } = self else { return vec![true; names.len()] };
        let mut among = vec![false; names.len()];
        for place in attributes.iter().filter_map(|asked| names::find(names.clone(), asked)) {
            among[place] = true;
        }
        among
    }
}
