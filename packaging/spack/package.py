"""Spack's recipe for Amontons."""
from spack.package import *


class Amontons(CMakePackage):
    """Plane and axisymmetric contact with Coulomb friction: a Fortran program and library with interfaces to C and
    Python."""

    # A repository of recipes wants the address of an archive here; without one, build from a copy of the sources:
    # spack dev-build amontons@0.3.0
    license("BSD-3-Clause")
    version("0.3.0")

    variant("shared", default=True, description="Build the C interface, which the Python package loads")
    variant("suitesparse", default=True, description="Use CHOLMOD and UMFPACK, which are under the GPL")
    variant("python", default=False, when="+shared", description="Install what the Python package needs")

    depends_on("c", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("blas")
    depends_on("lapack")
    depends_on("suite-sparse", when="+suitesparse")
    depends_on("python@3.9:", type="run", when="+python")
    depends_on("py-numpy@1.20:", type="run", when="+python")
    depends_on("py-matplotlib@3.6:", type="run", when="+python")

    conflicts("%gcc@:11", msg="gfortran 11 and older compile Amontons wrongly")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define("AMONTONS_TESTS", False),
            self.define_from_variant("AMONTONS_SHARED", "shared"),
            self.define_from_variant("AMONTONS_SUITESPARSE", "suitesparse"),
        ]

    def setup_run_environment(self, env):
        if self.spec.satisfies("+python"):
            env.prepend_path("PYTHONPATH", join_path(self.prefix.lib, "amontons"))
            env.prepend_path("PYTHONPATH", join_path(self.prefix.lib64, "amontons"))

    def test_version(self):
        """The program starts"""
        amontons = which(join_path(self.prefix.bin, "amontons"))
        assert str(self.spec.version) in amontons("--version", output=str.split)
