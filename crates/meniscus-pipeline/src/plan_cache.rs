//! Plans of one pipeline, made once for each set of facts.

use std::sync::Arc;

use meniscus_shader::Composer;
use meniscus_source::Report;

use crate::facts::Facts;
use crate::pipeline::Pipeline;
use crate::plan::{Plan, Pruning};

/// A pipeline's plans by the facts that they were made for. Looking one up takes no memory.
#[derive(Debug)]
pub struct PlanCache {
    pipeline: Pipeline,
    pruning: Pruning,
    shown: bool,
    /// Few, and in the order of the facts.
    plans: Vec<(Facts, Arc<Plan>)>,
}

impl PlanCache {
    /// An empty cache for plans that may leave out what `pruning` says; `shown`: see
    /// [`Plan::pruned`].
    pub fn new(pipeline: Pipeline, pruning: Pruning, shown: bool) -> Self {
        Self {
            pipeline,
            pruning,
            shown,
            plans: Vec::new(),
        }
    }

    /// The plan for facts: the one that is known, or else a new one.
    ///
    /// # Errors
    /// As [`Plan::pruned`].
    pub fn plan(&mut self, composer: &Composer, facts: Facts) -> Result<&Arc<Plan>, Report> {
        let at = match self.plans.binary_search_by_key(&facts, |(facts, _)| *facts) {
            Ok(known) => known,
            Err(place) => {
                let (pruning, shown) = (self.pruning, self.shown);
                let plan = Plan::pruned(&self.pipeline, composer, &facts, pruning, shown)?;
                self.plans.insert(place, (facts, Arc::new(plan)));
                place
            }
        };
        Ok(&self.plans[at].1)
    }

    /// How many plans it holds.
    pub fn len(&self) -> usize {
        self.plans.len()
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.plans.is_empty()
    }
}
