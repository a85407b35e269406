fn main() {
    let scene = energywave::Scene::from_file(std::env::args().nth(1).unwrap()).unwrap();
    let dev = std::env::args().nth(2).unwrap();
    let lanes: u32 = std::env::args().nth(3).unwrap().parse().unwrap();
    let d = energywave::Device::select(&dev).unwrap();
    let t = std::time::Instant::now();
    let mut r = energywave::Renderer::with_options(
        &d,
        &energywave::BuildOptions {
            lanes: Some(lanes),
            extra: String::new(),
        },
    )
    .unwrap_or_else(|e| {
        println!("{e}");
        std::process::exit(1)
    });
    println!("{d} new {:?}", t.elapsed());
    for _ in 0..6 {
        let t = std::time::Instant::now();
        let i = r.render(&scene).unwrap();
        println!("render {:?} {:?}", t.elapsed(), i.pixel(256, 256));
    }
    r.render(&scene)
        .unwrap()
        .save("/tmp/out.png", &scene.display)
        .unwrap();
}
