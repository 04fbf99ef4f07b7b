//! Conformance suites for user extensions, applied to the built-in shape functions, grids, transfers and methods.

use mpm_core::{
    Aflip, Apic, Blend, BlockGrid, BoundaryModified, CpGimp, Cpdi, Cpdi2, CubicBSpline, DenseGrid, Flip,
    Fmpm, FullSpace, Gimp, Linear, Method, Mls, Musl, Pic, PlaneStrain, QuadraticBSpline, Usf, Usl, conforms,
};

conforms! {
    shape_linear_2d: shape_function::<_, 2>(&Linear);
    shape_linear_3d: shape_function::<_, 3>(&Linear);
    shape_gimp: smooth::<_, 2>(&Gimp);
    shape_cpgimp: smooth::<_, 3>(&CpGimp);
    shape_quadratic: smooth::<_, 2>(&QuadraticBSpline);
    shape_modified: smooth::<_, 2>(&BoundaryModified(Gimp));
    shape_cubic: smooth::<_, 3>(&CubicBSpline);
    convected_cpdi_2d: convected::<_, 2>(&Cpdi);
    convected_cpdi_3d: convected::<_, 3>(&Cpdi);
    convected_cpdi2_2d: convected::<_, 2>(&Cpdi2);
    convected_cpdi2_3d: convected::<_, 3>(&Cpdi2);
    affine_gimp: affine_shape::<_, 2>(&Gimp);
    affine_cpgimp: affine_shape::<_, 2>(&CpGimp);
    affine_quadratic: affine_shape::<_, 3>(&QuadraticBSpline);
    affine_cubic: affine_shape::<_, 2>(&CubicBSpline);

    grid_block_2d: grid::<_, 2>(BlockGrid::new);
    grid_block_3d: grid::<_, 3>(BlockGrid::new);
    grid_dense_2d: grid::<_, 2>(|lattice| DenseGrid::new(lattice, [-24; 2], [40; 2]).expect("a box"));
    grid_dense_3d: grid::<_, 3>(|lattice| DenseGrid::new(lattice, [-24; 3], [40; 3]).expect("a box"));

    transfer_flip: transfer(Flip);
    transfer_pic: transfer(Pic);
    transfer_blend: transfer(Blend::new(0.5).expect("time constant"));
    transfer_aflip: transfer(Aflip::default());
    transfer_apic: transfer(Apic);
    transfer_mls: transfer(Mls);
    transfer_fmpm: transfer(Fmpm::<3>);

    method_linear_musl: method::<_, 3>(Method::new(Linear, Flip, Musl, FullSpace));
    method_gimp_usl: method::<_, 3>(Method::new(Gimp, Flip, Usl, FullSpace).compiled());
    method_cpgimp_usf: method::<_, 2>(Method::new(CpGimp, Flip, Usf, PlaneStrain).compiled());
    method_cpgimp_apic: method::<_, 2>(Method::new(CpGimp, Apic, Usl, PlaneStrain).compiled());
    method_cpdi_usl: method::<_, 3>(Method::new(Cpdi, Flip, Usl, FullSpace).compiled());
    method_cpdi2_musl: method::<_, 2>(Method::new(Cpdi2, Flip, Musl, PlaneStrain).compiled());
    method_quadratic_apic: method::<_, 3>(Method::new(QuadraticBSpline, Apic, Usl, FullSpace));
    method_quadratic_aflip: method::<_, 3>(Method::impact(FullSpace));
    method_cubic_apic: method::<_, 2>(Method::new(CubicBSpline, Apic, Usl, PlaneStrain).compiled());
}
