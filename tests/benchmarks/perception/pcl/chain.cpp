// The registration of Mascaro 2020, Sec. 4.4, put together from PCL's own parts, to be measured beside the project's.
//
//   chain TARGET SOURCE ISS_RADIUS SHOT_RADIUS
//
// Each file holds rows of four floats: x, y, z [m] and the number of the segment. Prints one JSON object: T
// (target from source, 16 numbers by row), milliseconds of processor time a stage, numbers of keypoints and matches.

#include <pcl/common/centroid.h>
#include <pcl/console/print.h>
#include <pcl/features/normal_3d.h>
#include <pcl/features/shot.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/keypoints/iss_3d.h>
#include <pcl/point_types.h>
#include <pcl/recognition/cg/geometric_consistency.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <map>
#include <vector>

using Point = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Point>;
using Normals = pcl::PointCloud<pcl::Normal>;
using Descriptors = pcl::PointCloud<pcl::SHOT352>;
using Transforms = std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>>;

struct Map {
    Cloud::Ptr points{new Cloud}, keypoints{new Cloud};
    Descriptors::Ptr descriptors{new Descriptors};
    std::vector<Eigen::Vector4f, Eigen::aligned_allocator<Eigen::Vector4f>> centroids;
    std::map<int, Cloud::Ptr> segments;
};

static double milliseconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * now.tv_sec + 1e-6 * now.tv_nsec;
}

static Map read(const char* path) {
    Map map;
    std::ifstream file(path, std::ios::binary);
    float row[4];
    while (file.read(reinterpret_cast<char*>(row), sizeof row)) {
        auto& segment = map.segments[static_cast<int>(row[3])];
        if (!segment) segment.reset(new Cloud);
        segment->push_back(Point(row[0], row[1], row[2]));
        map.points->push_back(Point(row[0], row[1], row[2]));
    }
    for (const auto& [number, segment] : map.segments) {
        Eigen::Vector4f centroid;
        pcl::compute3DCentroid(*segment, centroid);
        map.centroids.push_back(centroid);
    }
    return map;
}

static void find_keypoints(Map& map, double radius) {
    for (const auto& [number, segment] : map.segments) {
        pcl::ISSKeypoint3D<Point, Point> detector;
        pcl::search::KdTree<Point>::Ptr tree(new pcl::search::KdTree<Point>);
        Cloud found;
        detector.setSearchMethod(tree);
        detector.setSalientRadius(radius);
        detector.setNonMaxRadius(radius * 2 / 3);
        detector.setThreshold21(0.975);
        detector.setThreshold32(0.975);
        detector.setMinNeighbors(5);
        detector.setNumberOfThreads(1);
        detector.setInputCloud(segment);
        detector.compute(found);
        *map.keypoints += found;
    }
}

static void describe(Map& map, double normal_radius, double radius) {
    Normals::Ptr normals(new Normals);
    for (const auto& [number, segment] : map.segments) {
        pcl::NormalEstimation<Point, pcl::Normal> estimator;
        pcl::search::KdTree<Point>::Ptr tree(new pcl::search::KdTree<Point>);
        Normals found;
        Eigen::Vector4f middle;
        estimator.setSearchMethod(tree);
        estimator.setRadiusSearch(normal_radius);
        estimator.setInputCloud(segment);
        estimator.compute(found);
        pcl::compute3DCentroid(*segment, middle);
        for (std::size_t i = 0; i < found.size(); ++i) {  // away from the centroid, as the project does it
            const Eigen::Vector3f outward = (*segment)[i].getVector3fMap() - middle.head<3>();
            if (found[i].getNormalVector3fMap().dot(outward) < 0) found[i].getNormalVector3fMap() *= -1;
        }
        *normals += found;
    }
    // The joined cloud must list the points in the order of the normals.
    Cloud::Ptr ordered(new Cloud);
    for (const auto& [number, segment] : map.segments) *ordered += *segment;
    pcl::SHOTEstimation<Point, pcl::Normal, pcl::SHOT352> estimator;
    pcl::search::KdTree<Point>::Ptr tree(new pcl::search::KdTree<Point>);
    estimator.setSearchMethod(tree);
    estimator.setRadiusSearch(radius);
    estimator.setInputCloud(map.keypoints);
    estimator.setSearchSurface(ordered);
    estimator.setInputNormals(normals);
    estimator.compute(*map.descriptors);
}

static pcl::CorrespondencesPtr match(const Map& target, const Map& source) {
    pcl::CorrespondencesPtr matches(new pcl::Correspondences);
    pcl::KdTreeFLANN<pcl::SHOT352> tree;
    Descriptors::Ptr usable(new Descriptors);
    std::vector<int> rows;
    for (std::size_t i = 0; i < target.descriptors->size(); ++i) {
        if (!std::isfinite((*target.descriptors)[i].descriptor[0])) continue;
        usable->push_back((*target.descriptors)[i]);
        rows.push_back(static_cast<int>(i));
    }
    if (usable->empty()) return matches;
    tree.setInputCloud(usable);
    for (std::size_t i = 0; i < source.descriptors->size(); ++i) {
        if (!std::isfinite((*source.descriptors)[i].descriptor[0])) continue;
        std::vector<int> nearest(1);
        std::vector<float> squares(1);
        if (tree.nearestKSearch((*source.descriptors)[i], 1, nearest, squares) == 1)
            matches->push_back(pcl::Correspondence(static_cast<int>(i), rows[nearest[0]], squares[0]));
    }
    return matches;
}

// Of the ten motions of most matches, the one that brings most centroids within a metre of another (step 4).
static bool choose(const Map& target, const Map& source, const Transforms& motions,
                   std::vector<pcl::Correspondences> groups, Eigen::Matrix4f& chosen) {
    std::vector<std::size_t> order(motions.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return groups[a].size() > groups[b].size(); });
    int most = 0;
    float smallest = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < std::min<std::size_t>(order.size(), 10); ++k) {
        int votes = 0;
        float farthest = 0;
        for (const auto& centroid : source.centroids) {
            float nearest = std::numeric_limits<float>::infinity();
            for (const auto& other : target.centroids)
                nearest = std::min(nearest, (motions[order[k]] * centroid - other).head<3>().norm());
            if (nearest < 1.0f) {
                ++votes;
                farthest = std::max(farthest, nearest);
            }
        }
        if (votes > most || (votes == most && votes > 0 && farthest < smallest)) {
            most = votes;
            smallest = farthest;
            chosen = motions[order[k]];
        }
    }
    return most > 0;
}

static void refine(const Map& target, const Map& source, Eigen::Matrix4f& motion) {
    pcl::IterativeClosestPoint<Point, Point> icp;
    Cloud aligned;
    icp.setInputTarget(target.points);
    icp.setInputSource(source.points);
    icp.setMaxCorrespondenceDistance(0.3);
    icp.setMaximumIterations(50);
    icp.setTransformationEpsilon(1e-8);
    icp.align(aligned, motion);
    motion = icp.getFinalTransformation();
}

int main(int count, char** words) {
    if (count != 5) {
        std::fprintf(stderr, "usage: chain TARGET SOURCE ISS_RADIUS SHOT_RADIUS\n");
        return 2;
    }
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    Map target = read(words[1]), source = read(words[2]);
    const double iss = std::atof(words[3]), shot = std::atof(words[4]);
    std::vector<double> marks{milliseconds()};
    find_keypoints(target, iss);
    find_keypoints(source, iss);
    marks.push_back(milliseconds());
    describe(target, iss, shot);
    describe(source, iss, shot);
    marks.push_back(milliseconds());
    const auto matches = match(target, source);
    marks.push_back(milliseconds());
    pcl::GeometricConsistencyGrouping<Point, Point> grouping;
    Transforms motions;
    std::vector<pcl::Correspondences> groups;
    grouping.setGCSize(0.08);
    grouping.setGCThreshold(4);
    grouping.setInputCloud(source.keypoints);
    grouping.setSceneCloud(target.keypoints);
    grouping.setModelSceneCorrespondences(matches);
    grouping.recognize(motions, groups);
    Eigen::Matrix4f T = Eigen::Matrix4f::Identity();
    const bool found = choose(target, source, motions, groups, T);
    marks.push_back(milliseconds());
    if (found) refine(target, source, T);
    marks.push_back(milliseconds());
    std::printf("{\"found\": %s, \"keypoints\": [%zu, %zu], \"matches\": %zu, \"T\": [",
                found ? "true" : "false", target.keypoints->size(), source.keypoints->size(), matches->size());
    for (int i = 0; i < 16; ++i) std::printf("%s%.9g", i ? ", " : "", T(i / 4, i % 4));
    const char* names[] = {"keypoints", "description", "matching", "verification", "refinement"};
    std::printf("], \"timings_ms\": {");
    for (int i = 0; i < 5; ++i) std::printf("\"%s\": %.1f, ", names[i], marks[i + 1] - marks[i]);
    std::printf("\"total\": %.1f}}\n", marks.back() - marks.front());
    return 0;
}
