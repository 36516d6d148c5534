//! Numbers of nodes or elements, found by searching.

/// Numbers and indices, sorted.
#[derive(Clone, Debug, Default)]
pub(super) struct Labels {
    sorted: Vec<(u64, u32)>,
}

impl Labels {
    /// Sorts them.
    pub fn new(mut pairs: Vec<(u64, u32)>) -> Self {
        pairs.sort_unstable();
        Labels { sorted: pairs }
    }

    /// The index of a number.
    pub fn find(&self, label: u64) -> Option<u32> {
        let place = self
            .sorted
            .binary_search_by_key(&label, |(label, _)| *label)
            .ok()?;
        self.sorted.get(place).map(|(_, index)| *index)
    }

    /// Indices of the existing numbers from `first` to `last` in steps of `step`, without those in `except`.
    pub fn range(
        &self,
        first: u64,
        last: u64,
        step: u64,
        except: &[u64],
    ) -> impl Iterator<Item = u32> {
        let start = self.sorted.partition_point(|(label, _)| *label < first);
        self.sorted
            .get(start..)
            .unwrap_or(&[])
            .iter()
            .take_while(move |(label, _)| *label <= last)
            .filter(move |(label, _)| (label - first).is_multiple_of(step.max(1)))
            .filter(|(label, _)| !except.contains(label))
            .map(|(_, index)| *index)
    }

    /// A number that appears twice.
    pub fn repeated(&self) -> Option<u64> {
        self.sorted.windows(2).find_map(|pair| match pair {
            [(one, _), (other, _)] if one == other => Some(*one),
            _ => None,
        })
    }

    /// All indices.
    pub fn indices(&self) -> impl Iterator<Item = u32> {
        self.sorted.iter().map(|(_, index)| *index)
    }

    /// The largest number.
    pub fn largest(&self) -> u64 {
        self.sorted.last().map_or(0, |(label, _)| *label)
    }

    /// Whether both have a number in common.
    pub fn meets(&self, other: &Labels) -> bool {
        self.sorted
            .iter()
            .any(|(label, _)| other.find(*label).is_some())
    }
}
