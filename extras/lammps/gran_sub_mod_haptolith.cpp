/* ----------------------------------------------------------------------
   haptolith's law of contacts as sub-models of LAMMPS' pair style granular and of fix wall/gran granular.
   Derived from the interface of LAMMPS (https://www.lammps.org), and like it under the GNU General Public License,
   version 2: see LICENSE in this folder. README.md says how it is built in and what the numbers are.
------------------------------------------------------------------------- */

#include "gran_sub_mod_haptolith.h"

#include "error.h"
#include "granular_model.h"
#include "math_extra.h"

#include <algorithm>
#include <cmath>

using namespace LAMMPS_NS;
using namespace Granular_NS;
using namespace MathExtra;

/* ----------------------------------------------------------------------
   Along the normal, with a the distance of the centres of two grains of diameter 2R (larger ones are that much
   farther apart):

     F(a) = gamma / (a - a_min) - h           a_thr <= a < 2R,  h = gamma / (2R - a_min)
     F(a) = F(a_thr) + k (a_thr - a)          a < a_thr = a_min + sqrt(gamma / k)
     F(a) = -4 F_c s (1 - s)                  2R <= a < 2R + range,  s = (a - 2R) / range

   A damper beside it, c = C / (max(a, a_thr) - a_min), takes energy from approach and parting alike, but never pulls.
   What limits friction, over mu, is F where it repels, and cohesion's F_c max(1 - 2 s, 0)^2.
   A wall is a grain's mirror image: as far behind it as the grain is before it, coming as fast.
------------------------------------------------------------------------- */

GranSubModNormalHaptolith::GranSubModNormalHaptolith(GranularModel *gm, LAMMPS *lmp) :
    GranSubModNormal(gm, lmp), compression(0.0)
{
  num_coeffs = 8;
  cohesive_flag = 1;
}

/* ---------------------------------------------------------------------- */

void GranSubModNormalHaptolith::coeffs_to_local()
{
  diameter = coeffs[0];
  a_min = coeffs[1];
  gamma = coeffs[2];
  k = coeffs[3];
  pull = coeffs[4];
  range = coeffs[5];
  damper = coeffs[6];
  larger = coeffs[7];
  if (!(a_min > 0.0 && diameter > a_min && gamma > 0.0 && k > 0.0 && pull >= 0.0 && range >= 0.0 && damper >= 0.0) ||
      !(larger >= 0.0) || (pull > 0.0 && range == 0.0))
    error->all(FLERR, "Illegal haptolith normal model");

  a_thr = a_min + std::sqrt(gamma / k);
  h = gamma / (diameter - a_min);
  const double rounding = 1.0e-6 * diameter;    // of a spring, whose a_thr is 2R
  if (a_thr > diameter + rounding)
    error->all(FLERR, "Illegal haptolith normal model: gamma is more than k (2R - a_min)^2");
  damp = 0.0;    // the damper is in calculate_forces(): other sub models shall add none
  beyond_contact = larger < range ? 1 : 0;
}

/* ---------------------------------------------------------------------- */

void GranSubModNormalHaptolith::mix_coeffs(double *icoeffs, double *jcoeffs)
{
  for (int i = 0; i < num_coeffs; i++) {
    if (icoeffs[i] != jcoeffs[i])
      error->all(FLERR, "The haptolith normal model mixes nothing: give a pair_coeff for each pair of types");
    coeffs[i] = icoeffs[i];
  }
  coeffs_to_local();
}

/* ----------------------------------------------------------------------
   a: radii in LAMMPS may be larger, by `larger` in a pair, so that what is found as touching is as far as cohesion
------------------------------------------------------------------------- */

double GranSubModNormalHaptolith::distance() const
{
  const double overlap = gm->contact_type == PAIR ? gm->delta : 2.0 * gm->delta;
  return diameter + larger - overlap;
}

/* ---------------------------------------------------------------------- */

bool GranSubModNormalHaptolith::touch()
{
  double reach = range - larger;
  if (gm->contact_type != PAIR) reach *= 0.5;
  const double farthest = gm->radsum + reach;
  return gm->rsq < farthest * farthest;
}

/* ---------------------------------------------------------------------- */

double GranSubModNormalHaptolith::pulloff_distance(double /*radi*/, double /*radj*/)
{
  return std::max(range - larger, 0.0);
}

/* ---------------------------------------------------------------------- */

double GranSubModNormalHaptolith::calculate_forces()
{
  const double a = distance();
  const double held = std::max(a, a_thr);
  const double repulsion = std::max(k * (held - a) + gamma / (held - a_min) - h, 0.0);
  double across_gap = 0.0;
  compression = repulsion;
  if (pull > 0.0) {
    const double u = std::clamp(1.0 - 2.0 * (a - diameter) / range, -1.0, 1.0);
    const double near = std::max(u, 0.0);
    across_gap = pull * (1.0 - u * u);
    compression += pull * near * near;
  }
  const double force = repulsion - across_gap;
  const double parting = gm->contact_type == PAIR ? gm->vnnr : 2.0 * gm->vnnr;
  return std::max(force - damper / (held - a_min) * parting, std::min(force, 0.0));
}

/* ---------------------------------------------------------------------- */

void GranSubModNormalHaptolith::set_fncrit()
{
  Fncrit = compression;
}

/* ----------------------------------------------------------------------
   Across the normal, with the limit mu Fncrit:

     xi <- xi - (xi n) n + v_t dt,     |k_t xi| > limit:  xi <- limit / k_t xi / |xi|
     F_t = -(k_t xi + c_t v_t),        |F_t| > limit:     F_t <- limit F_t / |F_t|
------------------------------------------------------------------------- */

GranSubModTangentialHaptolith::GranSubModTangentialHaptolith(GranularModel *gm, LAMMPS *lmp) :
    GranSubModTangential(gm, lmp)
{
  num_coeffs = 3;
  size_history = 3;
}

/* ---------------------------------------------------------------------- */

void GranSubModTangentialHaptolith::coeffs_to_local()
{
  k = coeffs[0];
  lag = coeffs[1];
  mu = coeffs[2];
  damp = k * lag;    // Marshall's twisting model asks
  if (!(k > 0.0 && lag >= 0.0 && mu >= 0.0)) error->all(FLERR, "Illegal haptolith tangential model");
}

/* ---------------------------------------------------------------------- */

void GranSubModTangentialHaptolith::mix_coeffs(double *icoeffs, double *jcoeffs)
{
  for (int i = 0; i < num_coeffs; i++) {
    if (icoeffs[i] != jcoeffs[i])
      error->all(FLERR, "The haptolith tangential model mixes nothing: give a pair_coeff for each pair of types");
    coeffs[i] = icoeffs[i];
  }
  coeffs_to_local();
}

/* ---------------------------------------------------------------------- */

void GranSubModTangentialHaptolith::calculate_forces()
{
  const double reach = mu * gm->normal_model->get_fncrit() / k;
  double *stretch = &gm->history[history_index];

  if (gm->history_update) {
    const double along = dot3(stretch, gm->nx);
    for (int i = 0; i < 3; i++) stretch[i] += gm->dt * gm->vtr[i] - along * gm->nx[i];
  }
  const double length = len3(stretch);
  if (length > reach) scale3(reach / length, stretch);

  double wanted[3];
  for (int i = 0; i < 3; i++) wanted[i] = stretch[i] + lag * gm->vtr[i];
  const double wanted_length = len3(wanted);
  const double share = wanted_length > reach ? reach / wanted_length : 1.0;
  for (int i = 0; i < 3; i++) gm->fs[i] = -k * share * wanted[i];
}
