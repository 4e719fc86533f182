//! Errors, statistics, tables and reports.
