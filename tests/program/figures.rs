//! `energywave figures`: the papers' figures beside their captions.

use std::fs;

use energywave::papers::Figure;

use crate::common::program::{Folder, expect, stderr};

const SMALL: [&str; 4] = ["--size", "12x8", "--device", "reference"];

#[test]
fn all_figures_are_drawn_and_the_page_has_each_beside_its_caption() {
    let folder = Folder::new();
    let arguments = [&["figures", "-o", "new/folder"][..], &SMALL].concat();
    expect(&folder.run(&arguments), 0, "drawn: 62 figures in ");
    let at = folder.path().join("new/folder");
    let page = fs::read_to_string(at.join("index.html")).unwrap();
    let mut different = Vec::new();
    for figure in Figure::ALL {
        let name = format!("{}.png", figure.name);
        let picture = image::open(at.join(&name)).unwrap().into_rgb8();
        assert_eq!((picture.width(), picture.height()), (12, 8), "{name}");
        assert!(picture.iter().any(|value| *value > 40), "{name} is black");
        let begin = page.find(&format!("src=\"{name}\"")).unwrap();
        let caption = page[begin..].find(&figure.caption()).unwrap();
        assert!(
            !page[begin..begin + caption].contains("</figure>"),
            "{name}"
        );
        different.push(picture.into_raw());
    }
    assert_eq!(fs::read_dir(at).unwrap().count(), 1 + Figure::ALL.len());
    different.sort();
    different.dedup();
    assert!(different.len() > 20, "{}", different.len());
}

#[test]
fn a_folder_that_cannot_take_all_figures_gets_none() {
    let folder = Folder::new();
    fs::write(folder.path().join("file"), "").unwrap();
    fs::create_dir_all(folder.path().join("full/figure-09.png")).unwrap();
    for (name, words) in [
        (
            "file",
            "error: file: cannot write: it is a file; the pictures need a folder",
        ),
        (
            "full",
            "error: full/figure-09.png: cannot write: it is a folder",
        ),
    ] {
        let output = folder.run(&[&["figures", "-o", name][..], &SMALL].concat());
        expect(&output, 7, words);
        assert_eq!(stderr(&output).lines().count(), 1);
    }
    assert_eq!(fs::read_dir(folder.path().join("full")).unwrap().count(), 1);
    expect(&folder.run(&["figures"]), 2, "--output <DIR>");
}
