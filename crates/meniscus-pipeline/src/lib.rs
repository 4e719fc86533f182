//! Pipelines declared in RON: variants, facts, plans, without a GPU.
