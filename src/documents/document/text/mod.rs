//! From the text of a document to its types and back. Reading names the place and the problem of a
//! mistake. Writing gives the same bytes for the same document, and a small change gives a small
//! difference. The JSON Schema is made from the types here, too. Nothing here opens a file: that is
//! the room `store`.

pub mod read;
pub mod schema;
pub mod write;
