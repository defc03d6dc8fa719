//! Where frames come from: folders of images and videos.
