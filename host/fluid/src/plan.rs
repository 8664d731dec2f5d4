//! What is computed, and what it takes: the plan of a pot.

/// One thing that a pot can compute.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// What it is.
    pub name: &'static str,
    /// How it is computed; `None` if it is not.
    pub how: Option<String>,
    /// Memory that it takes.
    pub bytes: usize,
}

impl Item {
    /// Something that is computed.
    #[must_use]
    pub fn on(name: &'static str, how: impl Into<String>, bytes: usize) -> Self {
        Self { name, how: Some(how.into()), bytes }
    }

    /// Something that is not computed, and takes no memory.
    #[must_use]
    pub fn off(name: &'static str) -> Self {
        Self { name, how: None, bytes: 0 }
    }

    /// The one or the other.
    #[must_use]
    pub fn if_any(name: &'static str, how: Option<(impl Into<String>, usize)>) -> Self {
        how.map_or(Self::off(name), |(how, bytes)| Self::on(name, how, bytes))
    }
}
