#!/usr/bin/env bash
# FCL 0.7: the sign of Contact::penetration_depth depends on the pair of shapes and on the solver.
# Expected: overlapping shapes have one sign of penetration_depth. A unit box and shapes of radius or half width 0.1, whose centres are
# 0.02 outside one of its faces, overlap by 0.08.
# Seen: with GST_INDEP the depth of box and box or ball is +0.08, of box and cylinder or capsule -0.08, and of a ball in the box's
# mesh -0.08 with either solver. The sum of depths, or a comparison with 0, is wrong for half of a robot's links.
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
debian libfcl-dev=0.7.0-3+b1 libeigen3-dev
run_cpp -lfcl -lccd -loctomap -loctomath <<'CPP'
#include <fcl/fcl.h>
#include <cmath>
#include <cstdio>
using namespace fcl;
using Shape = std::shared_ptr<CollisionGeometryd>;

double depth(const Shape& box, const Shape& shape, GJKSolverType solver) {
  CollisionObjectd a(box), b(shape, Eigen::Matrix3d::Identity(), Vector3d(0.52, 0.001, 0.002));
  CollisionRequestd request(100, true);
  request.gjk_solver_type = solver;
  CollisionResultd result;
  collide(&a, &b, request, result);
  return result.isCollision() ? result.getContact(0).penetration_depth : NAN;
}

int main() {
  auto box = std::make_shared<Boxd>(1, 1, 1);
  auto mesh = std::make_shared<BVHModel<OBBRSSd>>();
  generateBVHModel(*mesh, *box, Transform3d::Identity());
  const Shape ball = std::make_shared<Sphered>(0.1), small = std::make_shared<Boxd>(0.2, 0.2, 0.2),
              cylinder = std::make_shared<Cylinderd>(0.1, 0.2), capsule = std::make_shared<Capsuled>(0.1, 0.2);
  bool as_told = true;
  printf("FCL %s:", FCL_VERSION);
  for (GJKSolverType solver : {GST_LIBCCD, GST_INDEP}) {
    const double depths[] = {depth(box, small, solver), depth(box, ball, solver), depth(box, cylinder, solver),
                             depth(box, capsule, solver), depth(mesh, ball, solver)};
    const int turned = solver == GST_INDEP ? -1 : 1, signs[] = {1, 1, turned, turned, -1};
    printf(" %s: box %.2f, ball %.2f, cylinder %.2f, capsule %.2f, ball in mesh %.2f;",
           solver == GST_INDEP ? "GST_INDEP" : "GST_LIBCCD", depths[0], depths[1], depths[2], depths[3], depths[4]);
    for (int k = 0; k < 5; ++k) as_told = as_told && std::abs(depths[k] - 0.08 * signs[k]) < 1e-3;
  }
  puts("");
  return as_told ? 0 : 1;
}
CPP
