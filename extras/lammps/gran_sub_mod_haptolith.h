/* -*- c++ -*- ----------------------------------------------------------
   haptolith's law of contacts as sub-models of LAMMPS' pair style granular and of fix wall/gran granular.
   Derived from the interface of LAMMPS (https://www.lammps.org), and like it under the GNU General Public License,
   version 2: see LICENSE in this folder. README.md says how it is built in and what the numbers are.
------------------------------------------------------------------------- */

#ifdef GRAN_SUB_MOD_CLASS
// clang-format off
GranSubModStyle(haptolith,GranSubModNormalHaptolith,NORMAL);
GranSubModStyle(haptolith,GranSubModTangentialHaptolith,TANGENTIAL);
// clang-format on
#else

#ifndef LMP_GRAN_SUB_MOD_HAPTOLITH_H
#define LMP_GRAN_SUB_MOD_HAPTOLITH_H

#include "gran_sub_mod_normal.h"
#include "gran_sub_mod_tangential.h"

namespace LAMMPS_NS {
namespace Granular_NS {

  /// Along the normal: repulsion that begins as a hyperbola and goes on as a line, a pull across gaps, and a damper
  /// that never pulls.
  class GranSubModNormalHaptolith : public GranSubModNormal {
   public:
    GranSubModNormalHaptolith(class GranularModel *, class LAMMPS *);
    void coeffs_to_local() override;
    void mix_coeffs(double *, double *) override;
    bool touch() override;
    double pulloff_distance(double, double) override;
    double calculate_forces() override;
    void set_fncrit() override;

   protected:
    double diameter, a_min, gamma, k, pull, range, damper, larger;
    double a_thr, h;    // what follows from them
    double compression;

    double distance() const;
  };

  /// Across it: Cundall and Strack's spring and slider, and a damper beside it that stays out of the spring.
  class GranSubModTangentialHaptolith : public GranSubModTangential {
   public:
    GranSubModTangentialHaptolith(class GranularModel *, class LAMMPS *);
    void coeffs_to_local() override;
    void mix_coeffs(double *, double *) override;
    void calculate_forces() override;

   protected:
    double lag;
  };

}    // namespace Granular_NS
}    // namespace LAMMPS_NS

#endif
#endif
