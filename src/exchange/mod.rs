//! Foreign formats, one a file or folder.
//!
//! The annotations that the method's authors published are read as a document: [`read_authors_folder`].

pub(crate) mod authors_mat;

pub use authors_mat::{
    AuthorsError, AuthorsFolder, AuthorsFrame, AuthorsSequence, MatError, read_authors_folder, read_authors_sequence,
};
