# Jobs on a store that fails.
fascicle_test(job_faults_test SOURCES job_faults_test.cc DEPS server/jobs server/store core/geometry core/sim TIMEOUT 180)
# Jobs on a small disk that fills up.
fascicle_test(full_disk_test SOURCES full_disk_test.cc DEPS server/jobs server/store core/geometry core/sim TIMEOUT 180)
