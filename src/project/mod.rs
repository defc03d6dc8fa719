//! The document: schema, history, journal, atomic store.
