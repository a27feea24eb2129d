// Many jobs: owners, settings, lists, pauses, watches.
#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

#include "tests/support/files.h"
#include "tests/support/service_fixture.h"

namespace fascicle::service_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

v1::Scene Tiny(const std::string& name = "tiny") {
  v1::Scene scene = SwingingBox(0.01, 0.01);
  scene.set_name(name);
  return scene;
}

class ManyJobs : public ::testing::Test {
 protected:
  // Without workers jobs stay in the queue.
  void Start(int workers) {
    options_.data_directory = directory_.path().string();
    options_.workers = workers;
    options_.heartbeat_interval = 200ms;
    stubs_.reset();
    server_.reset();
    server_ = server::EmbeddedServer::Start(options_);
    stubs_ = std::make_unique<Stubs>(server_->address());
  }

  grpc::Status Create(v1::Job job, v1::Job& created) {
    v1::CreateJobRequest request;
    if (!job.has_scene()) *job.mutable_scene() = Tiny();
    *request.mutable_job() = std::move(job);
    return stubs_->Create(request, created);
  }
  std::string Submit(const std::string& owner, int priority = 0, const v1::Scene& scene = Tiny()) {
    v1::Job job, created;
    job.set_owner(owner);
    job.set_priority(priority);
    *job.mutable_scene() = scene;
    (*job.mutable_labels())["of"] = owner;
    const grpc::Status status = Create(job, created);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return created.name();
  }
  grpc::Status List(const v1::ListJobsRequest& request, v1::ListJobsResponse& response) {
    grpc::ClientContext context;
    return stubs_->jobs->ListJobs(&context, request, &response);
  }
  // Names of all jobs that pass, by pages of two.
  std::vector<std::string> Names(const std::string& filter, const std::string& order = "") {
    std::vector<std::string> names;
    v1::ListJobsRequest request;
    request.set_filter(filter);
    request.set_order_by(order);
    request.set_page_size(2);
    do {
      v1::ListJobsResponse page;
      const grpc::Status status = List(request, page);
      EXPECT_TRUE(status.ok()) << status.error_message();
      for (const v1::Job& job : page.jobs()) names.push_back(job.name());
      request.set_page_token(page.next_page_token());
    } while (!request.page_token().empty());
    return names;
  }
  grpc::Status Pause(const std::string& name, v1::Job& job) {
    grpc::ClientContext context;
    v1::PauseJobRequest request;
    request.set_name(name);
    return stubs_->jobs->PauseJob(&context, request, &job);
  }
  grpc::Status Resume(const std::string& name, v1::Job& job) {
    grpc::ClientContext context;
    v1::ResumeJobRequest request;
    request.set_name(name);
    return stubs_->jobs->ResumeJob(&context, request, &job);
  }
  grpc::Status Update(const v1::UpdateJobRequest& request, v1::Job& job) {
    grpc::ClientContext context;
    return stubs_->jobs->UpdateJob(&context, request, &job);
  }
  grpc::Status Delete(const std::string& name) {
    grpc::ClientContext context;
    v1::DeleteJobRequest request;
    request.set_name(name);
    google::protobuf::Empty nothing;
    return stubs_->jobs->DeleteJob(&context, request, &nothing);
  }

  testing::TemporaryFolder directory_;
  server::ServerOptions options_;
  std::unique_ptr<server::EmbeddedServer> server_;
  std::unique_ptr<Stubs> stubs_;
};

TEST_F(ManyJobs, SettingsAreKeptAndCanBeChanged) {
  Start(0);
  v1::Job job, created;
  job.set_owner("ann");
  job.set_priority(7);
  job.mutable_ttl()->set_seconds(3600);
  (*job.mutable_labels())["study"] = "left knee";
  ASSERT_TRUE(Create(job, created).ok());
  v1::UpdateJobRequest request;
  request.mutable_job()->set_name(created.name());
  request.mutable_job()->set_priority(-2);
  request.mutable_job()->set_pinned(true);
  (*request.mutable_job()->mutable_labels())["a/b"] = "1";
  for (const char* path : {"priority", "pinned", "labels.a/b", "labels.none"})
    request.mutable_update_mask()->add_paths(path);
  ASSERT_TRUE(Update(request, job).ok());
  Start(0);  // another process
  job = stubs_->Get(created.name());
  EXPECT_EQ(job.owner(), "ann");
  EXPECT_EQ(job.priority(), -2);
  EXPECT_TRUE(job.pinned());
  EXPECT_EQ(job.ttl().seconds(), 3600);
  EXPECT_EQ(job.labels().size(), 2u);
  EXPECT_EQ(job.labels().at("study"), "left knee");
  EXPECT_EQ(job.labels().at("a/b"), "1");
  EXPECT_GT(job.revision(), created.revision());
  request.mutable_update_mask()->clear_paths();
  request.mutable_update_mask()->add_paths("labels.study");
  ASSERT_TRUE(Update(request, job).ok());
  EXPECT_EQ(job.labels().size(), 1u) << "a label that the request does not have is removed";
}

TEST_F(ManyJobs, WrongSettingsAreToldAllAtOnce) {
  Start(0);
  v1::Job job, created;
  job.set_owner("a b");
  job.set_priority(101);
  job.mutable_ttl()->set_seconds(-1);
  (*job.mutable_labels())["a=b"] = "x";
  (*job.mutable_labels())["c"] = "two\nlines";
  const auto fields_of = [](const grpc::Status& status) {
    EXPECT_EQ(ReasonOf(status), "3 INVALID_ARGUMENT");
    std::set<std::string> fields;
    const auto bad = DetailOf<google::rpc::BadRequest>(status);
    for (const auto& violation : bad->field_violations()) fields.insert(violation.field());
    return fields;
  };
  EXPECT_EQ(fields_of(Create(job, created)),
            (std::set<std::string>{"job.owner", "job.priority", "job.ttl", "job.labels.a=b", "job.labels.c"}));
  v1::UpdateJobRequest request;
  *request.mutable_job() = job;
  request.mutable_job()->set_name("x");
  for (const char* path : {"priority", "ttl", "labels", "scene"}) request.mutable_update_mask()->add_paths(path);
  EXPECT_EQ(fields_of(Update(request, created)),
            (std::set<std::string>{"job.name", "job.priority", "job.ttl", "job.labels.a=b", "job.labels.c",
                                   "update_mask.paths[3]"}));
  v1::ListJobsRequest list;
  list.set_filter("colour=red");
  list.set_order_by("colour");
  list.set_page_size(-1);
  v1::ListJobsResponse page;
  EXPECT_EQ(fields_of(List(list, page)), (std::set<std::string>{"filter", "order_by", "page_size"}));
  request.mutable_update_mask()->clear_paths();
  request.mutable_update_mask()->add_paths("pinned");
  request.mutable_job()->set_name("jobs/none");
  EXPECT_EQ(ReasonOf(Update(request, created)), "5 NOT_FOUND");
}

TEST_F(ManyJobs, ListsHaveFiltersOrdersAndPages) {
  Start(0);
  std::vector<std::string> a, b;
  for (int i = 0; i < 5; ++i) {
    a.push_back(Submit("ann", i % 2, Tiny("knee " + std::to_string(i))));
    b.push_back(Submit("bob", 9, Tiny("hip")));
  }
  EXPECT_THAT(Names("owner=ann"), ElementsAre(a[4], a[3], a[2], a[1], a[0]));
  EXPECT_THAT(Names("owner=ann", "priority desc"), ElementsAre(a[3], a[1], a[4], a[2], a[0]));
  EXPECT_THAT(Names("name:knee", "created"), ElementsAre(a[0], a[1], a[2], a[3], a[4]));
  EXPECT_THAT(Names("name:\"knee 3\" OR labels.of=bob", "name"), ElementsAre(b[0], b[1], b[2], b[3], b[4], a[3]));
  EXPECT_EQ(Names("state=QUEUED AND priority<9 AND age<1h").size(), 0u) << "none has ended";
  EXPECT_EQ(Names("state=QUEUED AND priority<9").size(), 5u);
  // A token belongs to its list.
  v1::ListJobsRequest request;
  request.set_filter("owner=ann");
  request.set_page_size(1);
  v1::ListJobsResponse page;
  ASSERT_TRUE(List(request, page).ok());
  request.set_page_token(page.next_page_token());
  request.set_filter("owner=bob");
  EXPECT_EQ(ReasonOf(List(request, page)), "3 INVALID_ARGUMENT");
  // Jobs that come and go between pages repeat and hide no others.
  request.set_filter("owner=ann");
  request.set_page_size(2);
  ASSERT_TRUE(List(request, page).ok());
  Submit("ann");
  ASSERT_TRUE(stubs_->Cancel(a[3]).ok());
  ASSERT_TRUE(Delete(a[3]).ok());
  EXPECT_THAT((std::vector<std::string>{page.jobs(0).name()}), ElementsAre(a[3]));
  request.set_page_token(page.next_page_token());
  ASSERT_TRUE(List(request, page).ok());
  EXPECT_EQ(page.jobs(0).name(), a[1]);
  EXPECT_EQ(page.jobs(1).name(), a[0]);
}

TEST_F(ManyJobs, APausedJobGoesOnAfterARestartOfTheServerToTheSameFrames) {
  Start(1);
  const v1::Scene scene = LargeSteps(60);
  const std::string reference = stubs_->Submit(scene), name = stubs_->Submit(scene);
  ASSERT_TRUE(stubs_->AwaitState(reference, v1::Job::STATE_SUCCEEDED));
  ASSERT_TRUE(stubs_->AwaitFrames(name, 3));
  v1::Job job;
  ASSERT_TRUE(Pause(name, job).ok());
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_PAUSED));
  const std::string queued = stubs_->Submit(Tiny());
  ASSERT_TRUE(stubs_->AwaitState(queued, v1::Job::STATE_SUCCEEDED)) << "the worker is free";
  Start(1);
  EXPECT_EQ(stubs_->Get(name).state(), v1::Job::STATE_PAUSED);
  ASSERT_TRUE(Resume(name, job).ok());
  ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED));
  const auto expected = stubs_->List(reference), found = stubs_->List(name);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].digest(), expected[i].digest()) << i;
  EXPECT_EQ(ReasonOf(Pause(name, job)), "9 JOB_FINAL");
  EXPECT_EQ(ReasonOf(Resume(name, job)), "9 JOB_FINAL");
  EXPECT_EQ(ReasonOf(Pause("jobs/none", job)), "5 NOT_FOUND");
  EXPECT_EQ(ReasonOf(Resume("none", job)), "3 INVALID_ARGUMENT");
}

TEST_F(ManyJobs, LimitsOfOwnersAreRefusedWithWhatToDo) {
  options_.max_queued_per_owner = 1;
  Start(0);
  Submit("ann");
  v1::Job job, created;
  job.set_owner("ann");
  const grpc::Status status = Create(job, created);
  EXPECT_EQ(ReasonOf(status), "8 OWNER_LIMIT");
  const auto quota = DetailOf<google::rpc::QuotaFailure>(status);
  ASSERT_TRUE(quota);
  EXPECT_THAT(quota->violations(0).description(), HasSubstr("cancel some"));
  Submit("bob");
  grpc::ClientContext context;
  v1::ServerInfo info;
  ASSERT_TRUE(stubs_->server->GetServerInfo(&context, {}, &info).ok());
  EXPECT_EQ(info.max_queued_jobs_per_owner(), 1);
  EXPECT_EQ(info.queued_jobs(), 2);
  EXPECT_GE(info.cores(), 1);
}

TEST_F(ManyJobs, WhatWasRemovedToMakeRoomIsTold) {
  options_.disk_budget = 1;
  options_.retention_interval = 20ms;
  Start(1);
  const std::string name = stubs_->Submit(Tiny());
  ASSERT_TRUE(Eventually([&] { return stubs_->Get(name).first_frame() == 2; }));
  EXPECT_EQ(stubs_->Get(name).stored_bytes(), 0);
  EXPECT_EQ(stubs_->Get(name).state(), v1::Job::STATE_SUCCEEDED);
  v1::StreamFramesRequest request = AllFramesOf(name);
  const StreamRecord record = ReadStream(*stubs_, request);
  EXPECT_EQ(ReasonOf(record.status), "11 FRAMES_REMOVED");
  EXPECT_THAT(record.status.error_message(), HasSubstr("before index 2"));
  request.set_start_index(2);
  EXPECT_TRUE(ReadStream(*stubs_, request).status.ok());
  grpc::ClientContext context, other;
  v1::ListFramesRequest list;
  list.set_name(name);
  v1::ListFramesResponse frames;
  EXPECT_EQ(ReasonOf(stubs_->frames->ListFrames(&context, list, &frames)), "11 FRAMES_REMOVED");
  v1::GetGeometryRequest geometry;
  geometry.set_name(name);
  v1::GetGeometryResponse part;
  const auto reader = stubs_->frames->GetGeometry(&other, geometry);
  EXPECT_FALSE(reader->Read(&part));
  EXPECT_EQ(ReasonOf(reader->Finish()), "5 NOT_FOUND");
}

// A reader of WatchJobs, which knows what it was told.
class Watcher {
 public:
  explicit Watcher(std::string filter = "") : filter_(std::move(filter)) {}

  // Reads until `enough` or the end of the stream, whose status it returns.
  grpc::Status Read(Stubs& stubs, const std::function<bool()>& enough) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 20s);
    v1::WatchJobsRequest request;
    request.set_filter(filter_);
    request.set_revision(revision);
    const auto reader = stubs.jobs->WatchJobs(&context, request);
    v1::WatchJobsResponse response;
    while (!enough() && reader->Read(&response)) {
      EXPECT_GE(response.revision(), revision);
      for (const v1::Job& job : response.jobs()) {
        EXPECT_GT(job.revision(), revision);
        EXPECT_LE(job.revision(), response.revision());
        states[job.name()] = job.state();
      }
      for (const std::string& name : response.removed()) states.erase(name);
      revision = response.revision();
    }
    if (enough()) context.TryCancel();
    return reader->Finish();
  }

  std::int64_t revision = 0;
  std::map<std::string, v1::Job::State> states;

 private:
  const std::string filter_;
};

TEST_F(ManyJobs, AWatcherThatComesAgainMissesNothing) {
  Start(2);
  std::vector<std::string> names;
  for (int i = 0; i < 3; ++i) names.push_back(Submit("ann"));
  Watcher watcher, filtered("owner=bob AND state=SUCCEEDED");
  watcher.Read(*stubs_, [&] { return watcher.states.size() == 3; });
  for (const std::string& name : names) ASSERT_TRUE(stubs_->AwaitState(name, v1::Job::STATE_SUCCEEDED));
  names.push_back(Submit("bob"));
  ASSERT_TRUE(stubs_->AwaitState(names[3], v1::Job::STATE_SUCCEEDED));
  ASSERT_TRUE(Delete(names[0]).ok());
  const auto is_complete = [&] {
    return watcher.states.size() == 3 && !watcher.states.contains(names[0]) &&
           std::all_of(watcher.states.begin(), watcher.states.end(),
                       [](const auto& state) { return state.second == v1::Job::STATE_SUCCEEDED; });
  };
  watcher.Read(*stubs_, is_complete);
  EXPECT_TRUE(is_complete());
  filtered.Read(*stubs_, [&] { return filtered.states.size() == 1; });
  EXPECT_TRUE(filtered.states.contains(names[3]));
  // Also over a restart of the server.
  Start(2);
  ASSERT_TRUE(Delete(names[1]).ok());
  watcher.Read(*stubs_, [&] { return !watcher.states.contains(names[1]); });
  EXPECT_EQ(watcher.states.size(), 2u);
  v1::UpdateJobRequest update;
  update.mutable_job()->set_name(names[3]);
  update.mutable_update_mask()->add_paths("pinned");
  v1::Job job;
  ASSERT_TRUE(Update(update, job).ok());
  EXPECT_TRUE(stubs_->Get(names[3]).revision() > watcher.revision);

  watcher.revision = 1'000'000;
  EXPECT_EQ(ReasonOf(watcher.Read(*stubs_, [] { return false; })), "11 REVISION");
  Watcher wrong("colour=red");
  EXPECT_EQ(ReasonOf(wrong.Read(*stubs_, [] { return false; })), "3 INVALID_ARGUMENT");
}

// While jobs come, run, change and go, watchers that are cut off again and again know at last what is true.
TEST_F(ManyJobs, WatchersThatAreCutOffAgreeWithTheServer) {
  Start(2);
  std::atomic<bool> is_over = false;
  std::thread busy([&] {
    std::mt19937 random(11);
    std::vector<std::string> names;
    for (int i = 0; i < 60; ++i) {
      names.push_back(Submit(i % 2 == 0 ? "ann" : "bob", i % 3));
      v1::Job job;
      const std::string& name = names[random() % names.size()];
      if (random() % 3 == 0) Pause(name, job);
      if (random() % 3 == 0) Resume(name, job);
      if (random() % 3 == 0) stubs_->Cancel(name);
      if (random() % 3 == 0) Delete(name);
    }
    is_over = true;
  });
  Watcher all, some("owner=ann AND state!=SUCCEEDED");
  std::mt19937 random(12);
  while (!is_over) {
    for (Watcher* watcher : {&all, &some}) {
      const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(random() % 40);
      watcher->Read(*stubs_, [&] { return std::chrono::steady_clock::now() > end || is_over; });
    }
  }
  busy.join();
  v1::Job job;
  for (const std::string& name : Names("state=PAUSED OR state=PAUSING")) stubs_->Cancel(name);
  ASSERT_TRUE(Eventually([&] { return Names("NOT state=SUCCEEDED AND NOT state=CANCELLED").empty(); }));
  for (Watcher* watcher : {&all, &some}) {
    const bool is_all = watcher == &all;
    std::map<std::string, v1::Job::State> expected;
    for (const std::string& name : Names(is_all ? "" : "owner=ann AND state!=SUCCEEDED")) {
      expected[name] = stubs_->Get(name).state();
    }
    watcher->Read(*stubs_, [&] { return watcher->states == expected; });
    EXPECT_EQ(watcher->states, expected) << (is_all ? "all" : "some");
  }
}

}  // namespace
}  // namespace fascicle::service_test
